#include "harness/scene/fetch.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <thread>

#include "harness/scene/bytes.h"
#include "harness/scene/open.h"
#include "harness/scene/sha256.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

using test::error_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Answers one request on the loopback interface with fixed bytes, then hangs up.
class OneAnswer {
 public:
  explicit OneAnswer(std::string answer) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(socket_, 1), 0);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, answer = std::move(answer)] {
      const int peer = ::accept(socket_, nullptr, nullptr);
      std::array<char, 4096> request{};
      if (::recv(peer, request.data(), request.size(), 0) > 0) (void)::send(peer, answer.data(), answer.size(), MSG_NOSIGNAL);
      ::close(peer);
    });
  }
  OneAnswer(const OneAnswer&) = delete;
  OneAnswer& operator=(const OneAnswer&) = delete;
  ~OneAnswer() {
    thread_.join();
    ::close(socket_);
  }
  [[nodiscard]] std::string address() const { return "http://127.0.0.1:" + std::to_string(port_) + "/file"; }

 private:
  int socket_;
  int port_ = 0;
  std::thread thread_;
};

TEST(Download, TakesTheWholeFile) {
  const test::TempFolder folder;
  const OneAnswer server("HTTP/1.1 200 OK\r\nContent-Length: 5\r\nConnection: close\r\n\r\nhello");
  download(server.address(), folder.path() / "file", "http");
  EXPECT_EQ(as_text(map_file(folder.path() / "file")), "hello");
}

TEST(Download, SaysWhyItFailed) {
  const test::TempFolder folder;
  const auto error = [&folder](const std::string& answer) {
    const OneAnswer server(answer);
    std::string text = error_of([&] { download(server.address(), folder.path() / "file", "http"); });
    return text.replace(0, server.address().size(), "URL");
  };
  EXPECT_EQ(error("HTTP/1.1 200 OK\r\nContent-Length: 100\r\nConnection: close\r\n\r\nhello"), "URL: the download was cut short");
  EXPECT_EQ(error("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"), "URL: the server answered 404");
  EXPECT_EQ(error_of([&] { download("http://127.0.0.1:9/x", folder.path() / "file"); }),
            "http://127.0.0.1:9/x: Unsupported protocol");
  EXPECT_EQ(error_of([&] { download("https://x/y", folder.path() / "no" / "file"); }),
            folder.text() + "/no/file: cannot be written: No such file or directory");
}

TEST(Download, AFullDiskIsSaid) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const OneAnswer server("HTTP/1.1 200 OK\r\nContent-Length: 5\r\nConnection: close\r\n\r\nhello");
  EXPECT_EQ(error_of([&] { download(server.address(), "/dev/full", "http"); }),
            "/dev/full: cannot be written: No space left on device");
}

TEST(Source, IsTakenApart) {
  EXPECT_EQ(parse_source("https://a/b.ply").from, "https://a/b.ply");
  const FetchSource npm = parse_source("npm:@scope/name@1.2.3#models/a.ply");
  EXPECT_EQ(npm.kind, FetchSource::Kind::npm);
  EXPECT_EQ(npm.from, "@scope/name@1.2.3");
  EXPECT_EQ(npm.path, "models/a.ply");
  EXPECT_EQ(parse_source("deb:pack#usr/a").kind, FetchSource::Kind::deb);
  for (const char* bad :
       {"http://a/b", "npm:name#path", "npm:@scope/name#path", "deb:#path", "deb:pack", "deb:-o#path", "deb:pack#"}) {
    EXPECT_EQ(error_of([&] { (void)parse_source(bad); }),
              std::string("'") + bad + "' is no source; expected https://…, npm:package@version#path or deb:package#path");
  }
}

/// Clients that hand out packages made by the test.
class Fetch : public ::testing::Test {
 protected:
  Fetch() {
    environment.folder.write("package.tgz", test::tarred({{"package/models/square.ply", std::string(test::square_ply)}}));
    const std::string data =
        test::tarred({{"./usr/share/square.zip", test::zipped({{"in/square.ply", std::string(test::square_ply)}})}});
    environment.folder.write("package.deb",
                             test::zipped({{"debian-binary", "2.0\n"}, {"control.tar.gz", "x"}, {"data.tar.gz", data}}));
    client("npm", "cp " + environment.folder.text() + "/package.tgz .\n[ \"$1 $3\" = 'pack square@1.0.0' ]");
    client("apt-get", "cp " + environment.folder.text() + "/package.deb .\n[ \"$1 $2\" = 'download square' ]");
  }
  void client(const std::string& name, const std::string& script) const {
    const std::string path = environment.folder.write("bin/" + name, "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
  [[nodiscard]] std::filesystem::path installed() const { return environment.folder.path() / "installed"; }
  /// What is below the folder of installed scenes, work folders included.
  [[nodiscard]] std::vector<std::string> left() const {
    std::vector<std::string> names;
    if (!std::filesystem::exists(installed())) return names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(installed())) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }
  [[nodiscard]] std::string error(const CatalogFile& file) const {
    return error_of([&] { (void)fetch_file(file, installed()); });
  }
  const std::string good = sha256_hex(test::square_ply);
  test::CleanEnvironment environment;
  test::ScopedVariable clients{"PATH", environment.folder.text() + "/bin:/usr/bin:/bin"};
};

TEST_F(Fetch, FromNpmAndDebian) {
  for (const char* get : {"npm:square@1.0.0#models/square.ply", "deb:square#usr/share/square.zip/in/square.ply"}) {
    std::filesystem::remove_all(installed());
    const auto file = fetch_file({"shapes/square.ply", good, get, {}}, installed());
    EXPECT_EQ(file, installed() / "shapes/square.ply");
    EXPECT_EQ(as_text(map_file(file)), test::square_ply);
    EXPECT_THAT(left(), ::testing::UnorderedElementsAre("shapes", "square.ply"));
  }
}

TEST_F(Fetch, WhatGoesWrongLeavesNothingBehind) {
  const std::string zeros(64, '0');
  const std::string npm = "npm:square@1.0.0#models/square.ply";
  EXPECT_EQ(error({"a.ply", zeros, npm, {}}),
            npm + ": the SHA-256 of what came is " + good + "; expected " + zeros + "; nothing was installed");
  EXPECT_EQ(error({"a.ply", good, "npm:square@1.0.0#models/sqare.ply", {}}),
            "square@1.0.0: the archive holds no 'package/models/sqare.ply'; did you mean 'package/models/square.ply'?");
  client("npm", "echo 'npm ERR! 404 no such package' >&2; exit 1");
  EXPECT_EQ(error({"a.ply", good, npm, {}}), "'npm pack --ignore-scripts square@1.0.0' failed: npm ERR! 404 no such package");
  client("npm", "exit 1");
  EXPECT_EQ(error({"a.ply", good, npm, {}}), "'npm pack --ignore-scripts square@1.0.0' failed: it said nothing");
  client("npm", "exit 0");
  EXPECT_THAT(error({"a.ply", good, npm, {}}), HasSubstr("the client left no package; expected a file *.tgz"));
  client("npm", "head -c 100 " + environment.folder.text() + "/package.tgz > cut.tgz");
  EXPECT_THAT(error({"a.ply", good, npm, {}}), HasSubstr("square@1.0.0: "));
  {
    const test::ScopedVariable nowhere("PATH", environment.folder.text());
    EXPECT_EQ(error({"a.ply", good, npm, {}}), "the client 'npm' is not on the PATH; expected the Debian package npm");
    EXPECT_EQ(error({"a.ply", good, "deb:square#usr/a", {}}),
              "the client 'apt-get' is not on the PATH; expected the Debian package apt");
  }
  EXPECT_THAT(left(), ElementsAre());
}

TEST_F(Fetch, ClearsAwayWhatAKilledRunLeft) {
  // No process has this number: the kernel's limit is 2^22.
  std::filesystem::create_directories(installed() / ".get-99999999-abcdef");
  environment.folder.write("installed/.get-99999999-abcdef/half.tgz", "x");
  (void)fetch_file({"a.ply", good, "npm:square@1.0.0#models/square.ply", {}}, installed());
  EXPECT_THAT(left(), ElementsAre("a.ply"));
}

TEST_F(Fetch, GetSceneInstallsIntoTheUsersCache) {
  CatalogEntry entry;
  entry.name = "square";
  entry.files = {{"none.ply", good, "", {}}, {"square.ply", good, "npm:square@1.0.0#models/square.ply", {}}};
  const auto fetched = get_scene(entry);
  EXPECT_THAT(fetched, ElementsAre(environment.folder.path() / "cache/raystudy/scenes/square.ply"));
  EXPECT_THAT(get_scene(entry), ElementsAre());
  entry.files = {{"none.ply", good, "", {}}};
  EXPECT_THROW((void)get_scene(entry), SceneNotInstalled);
}

TEST_F(Fetch, NeedsAHome) {
  const test::ScopedVariable cache("XDG_CACHE_HOME", std::nullopt);
  const test::ScopedVariable home("HOME", std::nullopt);
  CatalogEntry entry;
  entry.files = {{"square.ply", good, "npm:square@1.0.0#models/square.ply", {}}};
  EXPECT_EQ(error_of([&] { (void)get_scene(entry); }),
            "there is no folder to install scenes in; expected XDG_CACHE_HOME or HOME in the environment");
}

}  // namespace
}  // namespace raystudy
