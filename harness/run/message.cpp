#include "harness/run/message.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace raystudy {
namespace {

using nlohmann::json;

json to_json(const SceneOpened& m) { return {{"kind", "scene"}, {"hash", m.hash}}; }
json to_json(const CellMeasured& m) { return {{"kind", "cell"}, {"cell", m.cell}, {"result", result_to_json(m.result)}}; }
json to_json(const ScopeFailed& m) {
  return {{"kind", "failed"}, {"scope", m.scope}, {"index", m.index}, {"status", m.status}, {"reason", m.reason}};
}
json to_json(const Note& m) { return {{"kind", "note"}, {"text", m.text}}; }

}  // namespace

std::string message_text(const Message& message) {
  const json object = std::visit([](const auto& m) { return to_json(m); }, message);
  return object.dump(-1, ' ', false, json::error_handler_t::replace) + '\n';
}

Message parse_message(std::string_view line) {
  const json object = json::parse(line);
  const auto kind = object.at("kind").get<std::string>();
  if (kind == "scene") return SceneOpened{object.at("hash").get<std::string>()};
  if (kind == "cell") {
    return CellMeasured{object.at("cell").get<std::size_t>(),
                        result_from_json(object.at("result").get_ref<const std::string&>(), "a worker's message")};
  }
  if (kind == "failed") {
    return ScopeFailed{object.at("scope").get<Scope>(), object.at("index").get<std::size_t>(),
                       object.at("status").get<CellStatus>(), object.at("reason").get<std::string>()};
  }
  if (kind == "note") return Note{object.at("text").get<std::string>()};
  throw std::logic_error("parse_message: unknown kind");
}

void MessageSender::send(const Message& message) const {
  const std::string text = message_text(message);
  std::string_view rest = text;
  while (!rest.empty()) {
    const ssize_t sent = ::send(socket_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) _exit(1);  // the parent is gone
    rest.remove_prefix(static_cast<std::size_t>(sent));
  }
  char ack = 0;
  ssize_t got = 0;
  do {
    got = ::read(socket_, &ack, 1);
  } while (got < 0 && errno == EINTR);
  if (got <= 0) _exit(1);
}

bool MessageReceiver::read() {
  std::array<char, 65536> chunk{};
  const ssize_t got = ::read(socket_, chunk.data(), chunk.size());
  if (got < 0) return errno == EINTR || errno == EAGAIN;
  buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  return got > 0;
}

std::optional<Message> MessageReceiver::next() {
  const std::size_t end = buffer_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  Message message = parse_message(std::string_view(buffer_).substr(0, end));
  buffer_.erase(0, end + 1);
  return message;
}

void MessageReceiver::acknowledge() const { (void)::send(socket_, "+", 1, MSG_NOSIGNAL); }

}  // namespace raystudy
