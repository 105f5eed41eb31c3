#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "harness/run/board.h"
#include "harness/run/result.h"

namespace raystudy {

/// What a worker tells its parent over a socket. Each message is one line of JSON.
struct SceneOpened {
  std::string hash;
};
/// A measured cell: values and series; names and provenance are the parent's to fill in, but for the device.
struct CellMeasured {
  std::size_t cell = 0;  ///< into Plan::cells
  CellResult result;
};
/// All cells in scope that have no result yet get none.
struct ScopeFailed {
  Scope scope = Scope::scene;
  std::size_t index = 0;
  CellStatus status = CellStatus::failed;
  std::string reason;
};
/// For the user to read; the study goes on.
struct Note {
  std::string text;
};
using Message = std::variant<SceneOpened, CellMeasured, ScopeFailed, Note>;

[[nodiscard]] std::string message_text(const Message& message);
[[nodiscard]] Message parse_message(std::string_view line);

/// The worker's end. `send` returns when the parent has dealt with the message, so that what the parent does with it (writing a
/// file, drawing) never falls into a timed region, and a result is safe before anything else can go wrong.
class MessageSender {
 public:
  explicit MessageSender(int socket) : socket_(socket) {}
  void send(const Message& message) const;

 private:
  int socket_;
};

/// The parent's end.
class MessageReceiver {
 public:
  explicit MessageReceiver(int socket) : socket_(socket) {}
  /// Reads what has come. False at the end of the stream.
  bool read();
  /// The next whole message, where there is one.
  [[nodiscard]] std::optional<Message> next();
  /// Tells the worker that its message is dealt with.
  void acknowledge() const;

 private:
  int socket_;
  std::string buffer_;
};

}  // namespace raystudy
