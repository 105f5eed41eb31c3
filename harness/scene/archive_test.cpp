#include "harness/scene/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/scene/read.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

class Packed : public ::testing::Test {
 protected:
  [[nodiscard]] Scene read(const std::string& name, std::string_view content, const std::string& inner = "") const {
    return read_scene(environment.folder.write(name, content) + inner);
  }
  test::CleanEnvironment environment;
  const std::string ply{test::square_ply};
};

TEST_F(Packed, StreamsGiveTheSameScene) {
  const std::string hash = read("plain.ply", ply).hash;
  EXPECT_EQ(read("a.ply.gz", test::compressed(ply, archive_write_add_filter_gzip)).hash, hash);
  EXPECT_EQ(read("a.ply.xz", test::compressed(ply, archive_write_add_filter_xz)).hash, hash);
  EXPECT_EQ(read("a.ply.zst", test::compressed(ply, archive_write_add_filter_zstd)).hash, hash);
  EXPECT_EQ(read("A.PLY.BZ2", test::compressed(ply, archive_write_add_filter_bzip2)).name, "A");
}

TEST_F(Packed, FilesInsideArchives) {
  const std::string hash = read("plain.ply", ply).hash;
  EXPECT_EQ(read("one.zip", test::zipped({{"readme.txt", "hello"}, {"model/a.ply", ply}})).hash, hash);
  const auto two = std::vector<std::pair<std::string, std::string>>{{"x/a.ply", ply}, {"b.obj", test::square_obj()}};
  EXPECT_EQ(read("two.zip", test::zipped(two), "/x/a.ply").hash, hash);
  EXPECT_EQ(read("two.tar.gz", test::tarred(two), "/x/a.ply").hash, hash);
  EXPECT_EQ(read("two.tgz", test::tarred(two), "/b.obj").name, "b");
}

TEST_F(Packed, ArchivesInsideArchives) {
  const std::string pk3 = test::zipped({{"maps/level.bsp", test::small_bsp()}, {"maps/other.bsp", test::small_bsp()}});
  const Scene scene = read("package.tar.gz", test::tarred({{"./usr/pak.pk3", pk3}}), "/usr/pak.pk3/maps/level.bsp");
  EXPECT_EQ(scene.triangles.size(), 130U);
  EXPECT_EQ(scene.name, "level");
  const Scene packed = read("p.zip", test::zipped({{"m/a.ply.xz", test::compressed(ply, archive_write_add_filter_xz)}}));
  EXPECT_EQ(packed.name, "a");
}

TEST_F(Packed, MaterialsBesideTheModelInTheArchive) {
  const std::string obj = "mtllib lib/box.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
  const Scene scene = read("box.zip", test::zipped({{"m/lib/box.mtl", "newmtl red\nKd 1 0 0\n"}, {"m/box.obj", obj}}));
  EXPECT_EQ(scene.material_of(0).color, (Vec3{1, 0, 0}));
}

TEST_F(Packed, ReadInsideLeavesTheLastFilePacked) {
  const std::string gz = test::compressed(ply, archive_write_add_filter_gzip);
  const Bytes archive =
      to_bytes(test::tarred({{"package/models/a.ply.gz", gz}, {"package/pak.zip", test::zipped({{"b", "inner"}})}}));
  EXPECT_EQ(as_text(read_inside(archive, "p", "package/models/a.ply.gz")), gz);
  EXPECT_EQ(as_text(read_inside(archive, "p", "package/pak.zip/b")), "inner");
  EXPECT_EQ(test::error_of([&] { (void)read_inside(archive, "p", "package/pak.zp"); }),
            "p: the archive holds no 'package/pak.zp'; did you mean 'package/pak.zip'?");
}

TEST_F(Packed, EveryCutOfAnArchiveIsAnErrorOrTheWholeScene) {
  const std::string hash = read("plain.ply", ply).hash;
  for (const std::string& whole : {test::zipped({{"a.ply", ply}}), test::tarred({{"a.ply", ply}})}) {
    for (std::size_t size = 1; size < whole.size(); size += 7) {
      try {
        EXPECT_EQ(read("cut.zip", std::string_view(whole).substr(0, size)).hash, hash);
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("cut.zip"), std::string::npos) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace raystudy
