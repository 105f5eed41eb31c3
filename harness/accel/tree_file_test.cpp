#include "harness/accel/tree_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include "harness/accel/tree_layout.h"
#include "harness/accel/validate.h"
#include "tests/support/files.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"
#include "tests/support/wide_trees.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

std::string content_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const TreeNotes notes{1.5F, 2.5F, "surface-area{}", "pipeline: by hand\nseed: 7\n"};

/// Sets the checksum right, as another program that writes wrong trees would.
void seal(std::string& bytes) {
  const std::string_view all = bytes;
  const std::uint64_t sum = tree_layout::checksum({&all, 1});
  std::memcpy(bytes.data() + offsetof(tree_layout::Header, checksum), &sum, sizeof sum);
}

template <class T>
void put(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// One tree of each form, with its scene.
struct Example {
  std::string name;
  Scene scene;
  std::shared_ptr<const Accel> tree;
};

template <class Node>
Example wide_example(const std::string& name) {
  const test::HandMade<Node> made;
  return {name, made.scene, std::make_shared<WideBvh>(made.bvh)};
}

std::vector<Example> examples() {
  const Scene scene = test::scene_of(test::random_boxes(5, 1));
  return {{"bvh2", scene, std::make_shared<Bvh2>(test::random_tree(scene, 1, 2))},
          wide_example<WideNode<4>>("wide4"),
          wide_example<WideNode<8>>("wide8"),
          wide_example<WideNode<16>>("wide16"),
          wide_example<QuantizedNode<4>>("wide4_8bit"),
          wide_example<QuantizedNode<8>>("wide8_8bit"),
          wide_example<QuantizedNode<16>>("wide16_8bit")};
}

bool same(const Accel& a, const Accel& b) {
  if (const auto* bvh = dynamic_cast<const Bvh2*>(&a)) return test::same(*bvh, dynamic_cast<const Bvh2&>(b));
  return test::same(dynamic_cast<const WideBvh&>(a), dynamic_cast<const WideBvh&>(b));
}

class TreeFiles : public testing::TestWithParam<Example> {
 protected:
  TreeFiles() { save_tree(file_, tree(), scene(), notes); }

  [[nodiscard]] static const Scene& scene() { return GetParam().scene; }
  [[nodiscard]] static const Accel& tree() { return *GetParam().tree; }

  test::TempFolder folder_;
  std::string file_ = folder_.text() + "/a.tree";
};

TEST_P(TreeFiles, GiveBackTheTreeAndItsNotes) {
  const TreeFile loaded = load_tree(file_, scene());
  EXPECT_EQ(loaded.tree->kind(), tree().kind());
  EXPECT_TRUE(same(tree(), *loaded.tree));
  EXPECT_TRUE(same(tree(), *read_tree(file_).tree));
  EXPECT_EQ(loaded.scene, scene().name);
  EXPECT_EQ(loaded.scene_hash, scene().hash);
  EXPECT_EQ(loaded.scene_triangles, scene().triangles.size());
  EXPECT_EQ(loaded.notes.traversal, notes.traversal);
  EXPECT_EQ(loaded.notes.intersection, notes.intersection);
  EXPECT_EQ(loaded.notes.heuristic, notes.heuristic);
  EXPECT_EQ(loaded.notes.provenance, notes.provenance);
  EXPECT_EQ(loaded.bytes, fs::file_size(file_));
}

TEST_P(TreeFiles, AreTheSameForTheSameTree) {
  const std::string again = folder_.text() + "/again.tree";
  save_tree(again, *load_tree(file_, scene()).tree, scene(), notes);
  EXPECT_EQ(content_of(again), content_of(file_));
  EXPECT_EQ(folder_.names().size(), 2U) << "nothing else is left in the folder";
}

TEST_P(TreeFiles, CutOffAnywhereAreRefused) {
  const std::string whole = content_of(file_);
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    EXPECT_THROW((void)read_tree("cut", to_bytes(whole.substr(0, bytes))), Error) << bytes;
  }
  EXPECT_THROW((void)read_tree("long", to_bytes(whole + '\0')), Error);
}

TEST_P(TreeFiles, WithAnyByteChangedAreRefused) {
  std::string bytes = content_of(file_);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : {0x01, 0x80, 0xff}) {
      bytes[at] = static_cast<char>(bytes[at] ^ change);
      EXPECT_THROW((void)read_tree("mutant", to_bytes(bytes)), Error) << at;
      bytes[at] = static_cast<char>(bytes[at] ^ change);
    }
  }
}

/// What a writer with a mistake would make: whatever is loaded is valid.
TEST_P(TreeFiles, ChangedAndSealedAgainAreRefusedOrValid) {
  const std::string whole = content_of(file_);
  std::mt19937 random(20130901);
  const auto below = [&random](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const auto check = [&](std::string bytes) {
    seal(bytes);
    const Bytes content = to_bytes(bytes);
    try {
      (void)read_tree("mutant", content);
    } catch (const Error&) {
    }
    try {
      const TreeFile loaded = load_tree("mutant", content, scene());
      EXPECT_THAT(find_problems(*loaded.tree, scene()), testing::IsEmpty());
    } catch (const Error&) {
    }
  };
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int change : {0x01, 0x80, 0xff}) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ change);
      check(bytes);
    }
  }
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = whole;
    const std::size_t changes = 1 + below(3);
    for (std::size_t c = 0; c < changes; ++c) {
      const std::size_t at = below(bytes.size() / 4) * 4;
      put(bytes, at, below(2) == 0 ? static_cast<std::uint32_t>(random()) : static_cast<std::uint32_t>(below(20)));
    }
    check(bytes);
  }
}

std::string form_name(const testing::TestParamInfo<Example>& info) { return info.param.name; }
void PrintTo(const Example& example, std::ostream* out) { *out << example.name; }

INSTANTIATE_TEST_SUITE_P(Forms, TreeFiles, testing::ValuesIn(examples()), form_name);

/// Of a small Bvh2, unless said otherwise.
class TreeFileErrors : public testing::Test {
 protected:
  TreeFileErrors() { save_tree(file_, test::random_tree(scene_, 1), scene_, notes); }

  /// What reading the file says, FILE in place of its name.
  [[nodiscard]] std::string said(const std::string& bytes) const {
    folder_.write("a.tree", bytes);
    return shown(test::error_of([this] { (void)read_tree(file_); }));
  }
  /// The same with a checksum that is right.
  [[nodiscard]] std::string said_sealed(std::string bytes) const {
    seal(bytes);
    return said(bytes);
  }
  [[nodiscard]] std::string shown(std::string text) const {
    for (std::size_t at = 0; (at = text.find(file_)) != std::string::npos;) text.replace(at, file_.size(), "FILE");
    return text;
  }
  template <class T>
  [[nodiscard]] std::string with(std::size_t offset, T value) const {
    std::string bytes = whole();
    put(bytes, offset, value);
    return bytes;
  }
  [[nodiscard]] std::string whole() const { return content_of(file_); }

  Scene scene_ = test::scene_of(test::random_boxes(3, 1));
  test::TempFolder folder_;
  std::string file_ = folder_.text() + "/a.tree";
};

TEST_F(TreeFileErrors, OfWhatIsNoWholeTreeFile) {
  const std::string bytes = whole();
  EXPECT_EQ(said(""), "FILE: is no tree file; expected one that begins with 'RAYSTREE'");
  EXPECT_EQ(said("ply\nformat ascii 1.0\n"), "FILE: is no tree file; expected one that begins with 'RAYSTREE'");
  EXPECT_EQ(said(bytes.substr(0, 100)), "FILE: has 100 bytes; expected a header of 128: the file was cut off");
  EXPECT_EQ(said(bytes.substr(0, 300)), fmt::format("FILE: has 300 bytes; expected {}, as its header says", bytes.size()));
  EXPECT_EQ(said_sealed(with(8, std::uint32_t{2})),
            "FILE: is of version 2 of the format; expected version 1, the only one that is read");
  std::string damaged = bytes;
  damaged.back() = 'x';
  std::uint64_t kept = 0;
  std::memcpy(&kept, bytes.data() + 24, sizeof kept);
  const std::string_view view = damaged;
  EXPECT_EQ(said(damaged),
            fmt::format("FILE: is damaged: its checksum is {:016x}; expected {:016x}", tree_layout::checksum({&view, 1}), kept));
  fs::remove(file_);
  EXPECT_EQ(shown(test::error_of([this] { (void)read_tree(file_); })), "FILE: cannot be opened: No such file or directory");
}

TEST_F(TreeFileErrors, OfHeaders) {
  EXPECT_EQ(said_sealed(with(32, 3U)), "FILE: is of kind 3; expected 1 (bvh2) or 2 (wide-bvh)");
  save_tree(file_, test::random_tree(scene_, 1), scene_, notes);
  EXPECT_EQ(said_sealed(with(36, 4U)), "FILE: has 4 children a node; expected 2 of a bvh2");
  save_tree(file_, test::random_tree(scene_, 1), scene_, notes);
  EXPECT_EQ(said_sealed(with(40, 1U)), "FILE: has boxes of form 1; expected 0 (float)");
  save_tree(file_, test::random_tree(scene_, 1), scene_, notes);
  EXPECT_EQ(said_sealed(with(44, 2U)), "FILE: says 2 of duplicates; expected 0 or 1");
  save_tree(file_, test::random_tree(scene_, 1), scene_, notes);
  EXPECT_EQ(said_sealed(with(88, -1.0F)), "FILE: has the costs c_T = -1 and c_I = 2.5; expected finite ones >= 0");
  const test::HandMade<WideNode<4>> made;
  save_tree(file_, made.bvh, made.scene, notes);
  EXPECT_EQ(said_sealed(with(36, 2U)), "FILE: has 2 children a node; expected 4, 8 or 16 of a wide-bvh");
  save_tree(file_, made.bvh, made.scene, notes);
  EXPECT_EQ(said_sealed(with(40, 2U)), "FILE: has boxes of form 2; expected 0 (float) or 1 (8-bit)");
  save_tree(file_, made.bvh, made.scene, notes);
  EXPECT_EQ(said_sealed(with(120, 5U)), "FILE: wrong tree: the height is 5; the longest way has 2 nodes");
}

TEST_F(TreeFileErrors, OfSections) {
  const std::string bytes = whole();
  constexpr std::size_t table = 128;  // nodes, triangles, scene, heuristic, provenance, of 32 bytes each
  const auto changed = [&bytes](std::size_t offset, auto value) {
    std::string copy = bytes;
    put(copy, offset, value);
    return copy;
  };
  EXPECT_EQ(said_sealed(changed(12, 1000U)), "FILE: has 1000 sections; expected a table within the file");
  EXPECT_EQ(said_sealed(changed(table, 'm')), "FILE: has no section 'nodes'");
  EXPECT_EQ(said_sealed(changed(table + 16, std::uint64_t{321})),
            "FILE: section 'nodes' is at 321 with 192 bytes; expected a multiple of 64 from 288 on, within the file");
  EXPECT_EQ(said_sealed(changed(table + 24, std::uint64_t{1} << 40U)),
            "FILE: section 'nodes' is at 320 with 1099511627776 bytes; expected a multiple of 64 from 288 on, within the file");
  EXPECT_EQ(said_sealed(changed(table + 24, std::uint64_t{191})),
            "FILE: section 'nodes' has 191 bytes; expected a multiple of 32, at most 2^32 times");
  EXPECT_EQ(said_sealed(changed(table + 32 + 24, std::uint64_t{8})),
            "FILE: refers to 2 triangles; expected at least the scene's 3");
  std::string twice = bytes;
  std::memcpy(twice.data() + table + 96, "scene\0\0\0\0\0\0", 11);
  EXPECT_EQ(said_sealed(twice), "FILE: has two sections 'scene'; expected one");
}

/// There is room for a sixth entry between the table and the first section.
TEST_F(TreeFileErrors, NoneOfSectionsOfOtherNames) {
  std::string bytes = whole();
  bytes.resize(tree_layout::aligned(bytes.size()), '\0');
  put(bytes, 12, 6U);
  put(bytes, 16, bytes.size());
  std::memcpy(bytes.data() + 288, "remarks", 7);
  put(bytes, 288 + 16, bytes.size());
  EXPECT_EQ(said_sealed(bytes), "no error");
}

TEST_F(TreeFileErrors, OfOrders) {
  const test::HandMade<WideNode<4>> made;  // two nodes; the third section
  save_tree(file_, made.bvh, made.scene, notes);
  EXPECT_EQ(said_sealed(with(128 + 2 * 32 + 24, std::uint64_t{16})),
            "FILE: section 'orders' has 16 bytes; expected 16 for each of 2 nodes");
}

TEST_F(TreeFileErrors, OfWrongTrees) {
  EXPECT_EQ(said_sealed(with(320 + 24, 8U)),
            "FILE: wrong tree: inner node 0 has its children at 8, not an even slot in [2, 6)\n"
            "FILE: wrong tree: node slot 2 is not used\nFILE: wrong tree: node slot 3 is not used\n"
            "FILE: wrong tree: node slot 4 is not used\nFILE: wrong tree: node slot 5 is not used\n"
            "FILE: wrong tree: triangle 0 is in 0 leaves\nFILE: wrong tree: triangle 1 is in 0 leaves\n"
            "FILE: wrong tree: triangle 2 is in 0 leaves");
}

TEST_F(TreeFileErrors, OfAnotherScene) {
  Scene other = test::scene_of(test::random_boxes(4, 2));
  other.name = "other";
  EXPECT_EQ(shown(test::error_of([&] { (void)load_tree(file_, other); })),
            fmt::format("FILE: is of scene 'boxes' of 3 triangles (hash {}); expected scene 'other' of 4 triangles (hash {})",
                        scene_.hash, other.hash));
}

/// The hash is of the right scene, the triangles are others: only validation finds it.
TEST_F(TreeFileErrors, OfBoxesThatDoNotHoldTheScenesTriangles) {
  Scene moved = test::scene_of({{{5, 5, 5}, {6, 6, 6}}, {{0, 0, 0}, {0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}}});
  moved.hash = scene_.hash;
  EXPECT_THAT(shown(test::error_of([&] { (void)load_tree(file_, moved); })),
              testing::MatchesRegex("FILE: wrong tree: leaf [0-9] does not contain triangle [0-9]\n(.|\n)*"));
}

class OtherTree final : public Accel {
 public:
  [[nodiscard]] std::string_view kind() const override { return "other"; }
  [[nodiscard]] std::size_t bytes() const override { return 0; }
};

TEST_F(TreeFileErrors, OfSaving) {
  EXPECT_TRUE(is_saveable("bvh2"));
  EXPECT_TRUE(is_saveable("wide-bvh"));
  EXPECT_FALSE(is_saveable("embree"));
  fs::remove(file_);
  const auto said_of = [&](const Accel& tree) { return shown(test::error_of([&] { save_tree(file_, tree, scene_, notes); })); };
  EXPECT_EQ(said_of(OtherTree()), "FILE: a tree of kind 'other' cannot be saved; expected 'bvh2' or 'wide-bvh'");
  EXPECT_EQ(said_of(Bvh2()), "FILE: a wrong tree is not saved: the tree is empty but the scene has 3 triangles");
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_EQ(test::error_of([&] { save_tree("/proc/nowhere/a.tree", test::random_tree(scene_, 1), scene_, notes); }),
            "/proc/nowhere: cannot make the folder: No such file or directory");
}

TEST_F(TreeFileErrors, NoneOfATreeOverNoTriangles) {
  for (const Accel* tree : {static_cast<const Accel*>(new Bvh2), static_cast<const Accel*>(new WideBvh)}) {
    const std::unique_ptr<const Accel> owned(tree);
    save_tree(file_, *tree, Scene(), notes);
    const TreeFile loaded = load_tree(file_, Scene());
    EXPECT_TRUE(same(*tree, *loaded.tree));
    EXPECT_EQ(loaded.scene_hash, "");
  }
}

/// The offsets that tree_file.md gives, read as another program would.
TEST_F(TreeFileErrors, LayoutIsAsDescribed) {
  const test::HandMade<QuantizedNode<8>> made;
  save_tree(file_, made.bvh, made.scene, notes);
  const std::string bytes = whole();
  const auto at = [&bytes]<class T>(std::size_t offset, T) {
    T value{};
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 8), "RAYSTREE");
  EXPECT_EQ(at(8, 0U), 1U);
  EXPECT_EQ(at(12, 0U), 7U);
  EXPECT_EQ(at(16, std::uint64_t{}), bytes.size());
  EXPECT_EQ(at(32, 0U), 2U) << "kind";
  EXPECT_EQ(at(36, 0U), 8U) << "width";
  EXPECT_EQ(at(40, 0U), 1U) << "boxes";
  EXPECT_EQ(at(44, 0U), 0U) << "duplicates";
  EXPECT_EQ(at(48, std::uint64_t{}), 6U);
  EXPECT_EQ(bytes.substr(56, 32), made.scene.hash);
  EXPECT_EQ(at(88, 0.0F), 1.5F);
  EXPECT_EQ(at(92, 0.0F), 2.5F);
  EXPECT_EQ(at(96, 0.0F), 0.0F) << "bounds.lower.x";
  EXPECT_EQ(at(108, 0.0F), 11.0F) << "bounds.upper.x";
  EXPECT_EQ(at(120, 0U), 2U) << "height";
  EXPECT_EQ(bytes.substr(128, 6), std::string("nodes\0", 6));
  const std::uint64_t nodes = at(128 + 16, std::uint64_t{});
  EXPECT_EQ(nodes % 64, 0U);
  EXPECT_EQ(at(128 + 24, std::uint64_t{}), 2 * 96U);
  EXPECT_EQ(at(nodes + 15, std::int8_t{}), 3) << "slots in use of the root";
  EXPECT_EQ(at(nodes + 16 + 8 + 2, std::uint8_t{}), 11) << "upper x of its slot 2";
  EXPECT_EQ(at(nodes + 64, 0U), 1U) << "its first child";
}

}  // namespace
}  // namespace raystudy
