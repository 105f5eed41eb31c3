#include "harness/accel/tree_file.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "harness/accel/wide_bvh.h"
#include "harness/base/error.h"
#include "harness/method/registry.h"

namespace raystudy::tree_file {
namespace {

constexpr std::string_view binary_name = "tree-file";
constexpr std::string_view wide_name = "wide-tree-file";

/// A saved tree in the place of one that is built. `Tree` is what the file must hold.
template <class Tree>
class TreeFileBuilder final : public Builder {
 public:
  static constexpr bool binary = std::is_same_v<Tree, Bvh2>;
  static constexpr std::string_view name = binary ? binary_name : wide_name;

  explicit TreeFileBuilder(const Params& params) : file_(params.file("path")) {}

  static MethodInfo info() {
    return {
        .name = std::string(name),
        .summary = fmt::format("reads a {} tree that 'raystudy tree save' or another program wrote", binary ? "binary" : "wide"),
        .citation = "harness/accel/tree_file.md",
        .params = {file_param("path", "the tree file, over the very scene")},
        .accel = std::string(Tree::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext&) const override {
    if (file_.path.empty()) {
      throw Error(Diagnostic{{}, fmt::format("builder '{}' has no 'path'", name), "the name of a tree file", {}});
    }
    const Bytes content = map_file(file_.path);
    // A result would be kept under the name of what was there when the study was read.
    if (xxh3_hex(as_text(content)) != file_.hash) fail_at(file_.path, "has changed since the study was read");
    std::unique_ptr<Accel> tree = load_tree(file_.path, content, scene).tree;
    if (tree->kind() != Tree::kind_name) {
      fail_at(file_.path, fmt::format("holds a '{}'", tree->kind()),
              fmt::format("a '{}', or the builder '{}'", Tree::kind_name, binary ? wide_name : binary_name));
    }
    return tree;
  }

 private:
  FileRef file_;
};

const Registration<TreeFileBuilder<Bvh2>> binary_file;
const Registration<TreeFileBuilder<WideBvh>> wide_file;

}  // namespace
}  // namespace raystudy::tree_file
