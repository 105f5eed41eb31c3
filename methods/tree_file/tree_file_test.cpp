#include "harness/accel/tree_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "harness/method/registry.h"
#include "harness/spec/cell_id.h"
#include "tests/support/files.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"
#include "tests/support/wide_trees.h"

namespace raystudy {
namespace {

std::unique_ptr<Accel> build(const std::string& builder, const std::string& path, const Scene& scene) {
  const Registry& registry = Registry::instance();
  return registry.create<Builder>(registry.ref(Role::builder, builder, {{"path", path}}))->build(scene, {});
}

class TreeFileBuilders : public testing::Test {
 protected:
  TreeFileBuilders() {
    save_tree(binary_, bvh_, scene_, {});
    save_tree(wide_, made_.bvh, made_.scene, {});
  }
  [[nodiscard]] static std::string id(const std::string& path) {
    const Plan plan = parse_plan(fmt::format("scenes: [terrain: {{triangles: 1000}}]\nmethods: {{a: {{builder: {{tree-file: "
                                             "{{path: {}}}}}}}}}\n",
                                             path),
                                 "x.yaml", Scale::quick);
    return cell_id(plan, plan.cells.front());
  }

  Scene scene_ = test::scene_of(test::random_boxes(20, 1));
  Bvh2 bvh_ = test::random_tree(scene_, 1);
  test::HandMade<WideNode<8>> made_;
  test::TempFolder folder_;
  std::string binary_ = folder_.text() + "/binary.tree";
  std::string wide_ = folder_.text() + "/wide.tree";
};

TEST_F(TreeFileBuilders, GiveTheSavedTree) {
  EXPECT_TRUE(test::same(bvh_, dynamic_cast<const Bvh2&>(*build("tree-file", binary_, scene_))));
  EXPECT_TRUE(test::same(made_.bvh, dynamic_cast<const WideBvh&>(*build("wide-tree-file", wide_, made_.scene))));
}

TEST_F(TreeFileBuilders, RefuseTheOtherForm) {
  EXPECT_EQ(test::error_of([&] { (void)build("tree-file", wide_, made_.scene); }),
            wide_ + ": holds a 'wide-bvh'; expected a 'bvh2', or the builder 'wide-tree-file'");
  EXPECT_EQ(test::error_of([&] { (void)build("wide-tree-file", binary_, scene_); }),
            binary_ + ": holds a 'bvh2'; expected a 'wide-bvh', or the builder 'tree-file'");
}

TEST_F(TreeFileBuilders, RefuseAnotherScene) {
  EXPECT_THAT(test::error_of([&] { (void)build("tree-file", binary_, made_.scene); }),
              testing::StartsWith(binary_ + ": is of scene 'boxes' of 20 triangles (hash "));
}

TEST_F(TreeFileBuilders, RefuseAFileThatHasChangedSinceItWasNamed) {
  const Registry& registry = Registry::instance();
  const auto builder = registry.create<Builder>(registry.ref(Role::builder, "tree-file", {{"path", binary_}}));
  save_tree(binary_, test::random_tree(scene_, 2), scene_, {});
  EXPECT_EQ(test::error_of([&] { (void)builder->build(scene_, {}); }), binary_ + ": has changed since the study was read");
}

TEST_F(TreeFileBuilders, NeedAFile) {
  EXPECT_EQ(test::error_of([&] { (void)build("tree-file", "no.tree", scene_); }),
            "builder 'tree-file': parameter 'path' is the text 'no.tree'; expected the name of a file that can be read");
  const auto builder = Registry::instance().create<Builder>({"tree-file", nullptr});
  EXPECT_EQ(test::error_of([&] { (void)builder->build(scene_, {}); }),
            "builder 'tree-file' has no 'path'; expected the name of a tree file");
}

TEST_F(TreeFileBuilders, ContentIsPartOfACellsIdentity) {
  const std::string before = id(binary_);
  EXPECT_EQ(id(binary_), before);
  save_tree(binary_, test::random_tree(scene_, 2), scene_, {});
  const std::string after = id(binary_);
  EXPECT_NE(after, before);
  save_tree(binary_, bvh_, scene_, {});
  EXPECT_EQ(id(binary_), before);
}

}  // namespace
}  // namespace raystudy
