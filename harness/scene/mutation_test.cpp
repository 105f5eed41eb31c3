// Whatever happens to a file's bytes, reading it gives an Error or a scene.
#include <gtest/gtest.h>

#include <random>

#include "harness/scene/source.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&random](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const std::size_t changes = 1 + below(4);
  for (std::size_t c = 0; c < changes && !bytes.empty(); ++c) {
    const std::size_t at = below(bytes.size());
    switch (below(6)) {
      case 0: bytes[at] = static_cast<char>(below(256)); break;
      case 1: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
      case 2: bytes.erase(at, 1 + below(8)); break;
      case 3: bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(16))); break;
      case 4: bytes.resize(at); break;
      default: bytes.replace(at, 4, test::packed(static_cast<std::uint32_t>(below(2) == 0 ? 0xffffffffU : random()))); break;
    }
  }
  return bytes;
}

struct Case {
  std::string name;
  std::string extension;
  std::string content;
  int rounds = 2000;
};

class Mutation : public ::testing::TestWithParam<Case> {};

TEST_P(Mutation, GivesAnErrorOrAScene) {
  const Case& test_case = GetParam();
  std::mt19937 random(20130901);
  int good = 0;
  int bad = 0;
  for (int round = 0; round < test_case.rounds; ++round) {
    SourceFile source{.name = "mutant",
                      .stem = "mutant",
                      .extension = test_case.extension,
                      .bytes = to_bytes(round == 0 ? test_case.content : mutated(test_case.content, random)),
                      .in_archive = false,
                      .sibling = [](std::string_view) { return std::optional(to_bytes(test::small_gltf_buffer())); }};
    try {
      Scene scene = reader_for(source)(source);
      finish_scene(scene, source.name);
      ++good;
    } catch (const Error&) {
      ++bad;
    }
    ASSERT_GE(good, 1) << "the unchanged file is refused";
  }
  EXPECT_GT(bad, 0);
}

std::string name_of(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }
void PrintTo(const Case& input, std::ostream* out) { *out << input.name; }

INSTANTIATE_TEST_SUITE_P(
    Formats, Mutation,
    ::testing::Values(Case{"PlyAscii", "ply", std::string(test::square_ply)},
                      Case{"PlyBinary", "ply", test::square_ply_little_endian()},
                      Case{"Obj", "obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1/1/1 2//2 3\nf -1 -2 -3\n"},
                      Case{"StlAscii", "stl", test::square_stl_ascii()}, Case{"StlBinary", "stl", test::square_stl_binary()},
                      Case{"Off", "off", test::square_off()}, Case{"Bsp", "bsp", test::small_bsp()},
                      Case{"Gltf", "gltf", test::small_gltf("data.bin"), 1000},
                      Case{"GltfAnimated", "gltf", test::animated_gltf(), 1000}, Case{"Aff", "aff", test::small_aff(), 1000},
                      Case{"Ac3d", "ac", test::square_ac(), 300}),
    name_of);

}  // namespace
}  // namespace raystudy
