// scene list | info | get | check
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "harness/cli/verb.h"
#include "harness/scene/bytes.h"
#include "harness/scene/catalog.h"
#include "harness/scene/fetch.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"
#include "harness/scene/sha256.h"
#include "harness/scene/source.h"

namespace raystudy::cli {
namespace {

bool can_get(const CatalogEntry& entry) {
  for (const CatalogFile& file : entry.files) {
    if (!file.get.empty()) return true;
  }
  return false;
}

std::string state_of(const CatalogEntry& entry) {
  if (is_installed(entry)) return "installed";
  return can_get(entry) ? fmt::format("raystudy scene get {}", entry.name)
                        : "to be added by hand: raystudy scene info " + entry.name;
}

std::string count_text(const CatalogEntry& entry) {
  return entry.triangles == 0 ? "unknown" : fmt::format("{}", entry.triangles);
}

int list() {
  for (const ProceduralInfo& info : procedural_scenes()) {
    fmt::print("{:<24} {:>9}  built in: {}\n", info.name, "any", info.summary);
  }
  const Catalog catalog = read_catalog(catalog_path());
  for (const CatalogEntry& entry : catalog.entries) {
    fmt::print("{:<24} {:>9}  {}\n", entry.name, count_text(entry), state_of(entry));
  }
  return exit_ok;
}

void print_files(std::string_view title, const std::vector<CatalogFile>& files) {
  for (const CatalogFile& file : files) {
    const auto path = find_file(file);
    fmt::print("{:<10} {}\n", title, path ? path->string() : file.path + " (not at hand)");
    if (!file.sha256.empty()) fmt::print("{:<10}   sha256 {}\n", "", file.sha256);
    if (!file.get.empty()) fmt::print("{:<10}   from {}\n", "", file.get);
  }
}

int info(const std::string& name) {
  if (const ProceduralInfo* built_in = find_procedural(name)) {
    fmt::print("{}: {}\nbuilt in; any number of triangles from {} to {}{}\n", name, built_in->summary, procedural_triangles_min,
               built_in->triangles_max(), built_in->frames > 0 ? fmt::format("; {} key frames", built_in->frames) : "");
    return exit_ok;
  }
  const Catalog catalog = read_catalog(catalog_path());
  const CatalogEntry& entry = catalog_entry(catalog, name);
  fmt::print("{}: {}\n", entry.name, entry.title);
  fmt::print("{:<10} {}\n{:<10} {}\n{:<10} {}\n", "triangles", count_text(entry), "source", entry.source, "licence",
             entry.licence);
  print_files("file", entry.files);
  print_files("frame", entry.frames);
  for (const Camera& c : entry.cameras) {
    fmt::print("{:<10} {}: from ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g}), {:g} degrees\n", "camera", c.name, c.eye.x, c.eye.y,
               c.eye.z, c.target.x, c.target.y, c.target.z, c.vertical_fov);
  }
  fmt::print("{:<10} {}\n", "state", is_installed(entry) ? "installed" : not_installed_text(entry));
  return exit_ok;
}

int get(const std::vector<std::string>& names) {
  const Catalog catalog = read_catalog(catalog_path());
  for (const std::string& name : names) (void)catalog_entry(catalog, name);  // all names before the first download
  for (const std::string& name : names) {
    const auto fetched = get_scene(catalog_entry(catalog, name));
    if (fetched.empty()) fmt::print("{}: already installed\n", name);
    for (const auto& path : fetched) {
      fmt::print("{}: installed {} ({} bytes)\n", name, path.string(), std::filesystem::file_size(path));
    }
    const Scene scene = open_scene(name);
    fmt::print("{}: {} triangles, as expected\n", name, scene.triangles.size());
  }
  return exit_ok;
}

/// Hashes every file at hand, then opens the scene, which counts its triangles.
void check_scene(const CatalogEntry& entry) {
  std::vector<CatalogFile> files = entry.files;
  files.insert(files.end(), entry.frames.begin(), entry.frames.end());
  for (const CatalogFile& file : files) {
    const auto path = find_file(file);
    if (!path || file.sha256.empty()) continue;
    const auto disk = file_on_disk(*path);
    const std::string found = sha256_hex(as_text(map_file(disk)));
    if (found != file.sha256) {
      fail_at(disk.string(), fmt::format("the SHA-256 is {}", found),
              fmt::format("{}, as {} says", file.sha256, file.where.text()));
    }
  }
  (void)open_scene(entry.name);
}

int check(const std::vector<std::string>& names) {
  const Catalog catalog = read_catalog(catalog_path());
  std::vector<const CatalogEntry*> entries;
  entries.reserve(names.size());
  for (const std::string& name : names) entries.push_back(&catalog_entry(catalog, name));
  for (const CatalogEntry& entry : catalog.entries) {
    if (names.empty()) entries.push_back(&entry);
  }
  std::map<std::string, int> count;
  for (const CatalogEntry* entry : entries) {
    std::string verdict = "good";
    std::string text = fmt::format("{} triangles, {} files", count_text(*entry), entry->files.size() + entry->frames.size());
    try {
      check_scene(*entry);
    } catch (const SceneNotInstalled&) {
      verdict = "not at hand";
      text = state_of(*entry);
    } catch (const Error& error) {
      verdict = "BAD";
      text = error.what();
    }
    ++count[verdict];
    fmt::print("{:<24} {:<12} {}\n", entry->name, verdict, text);
  }
  fmt::print("{} good, {} bad, {} not at hand\n", count["good"], count["BAD"], count["not at hand"]);
  return count["BAD"] > 0 ? exit_bad_input : exit_ok;
}

std::function<int()> setup(CLI::App& app) {
  struct Names {
    std::string one;
    std::vector<std::string> some;
  };
  auto names = std::make_shared<Names>();
  auto action = std::make_shared<std::function<int()>>();
  app.require_subcommand(1);
  app.add_subcommand("list", "Every scene: triangles, and whether it is installed or how to get it")->callback([action] {
    *action = list;
  });
  CLI::App* info_verb = app.add_subcommand("info", "Source, licence, files and cameras of a scene");
  info_verb->add_option("NAME", names->one)->required();
  info_verb->callback([=] { *action = [names] { return info(names->one); }; });
  CLI::App* get_verb = app.add_subcommand("get", "Fetches scenes into the user's cache and verifies them");
  get_verb->add_option("NAME", names->some)->required();
  get_verb->callback([=] { *action = [names] { return get(names->some); }; });
  CLI::App* check_verb =
      app.add_subcommand("check", "Verifies hash and triangle count of every scene at hand, or of those named");
  check_verb->add_option("NAME", names->some);
  check_verb->callback([=] { *action = [names] { return check(names->some); }; });
  return [action] { return (*action)(); };
}

const Verb verb{"scene", "The catalog of scenes: list, info, get, check", setup};

}  // namespace
}  // namespace raystudy::cli
