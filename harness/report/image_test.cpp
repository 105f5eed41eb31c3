#include "harness/report/image.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <stdexcept>

#include "harness/base/error.h"

namespace raystudy {
namespace {

using testing::Each;
using testing::ElementsAre;

class Files : public testing::Test {
 public:
  Files() { std::filesystem::create_directories(folder_); }
  ~Files() override { std::filesystem::remove_all(folder_); }

 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / fmt::format("raystudy-image-{}", ::getpid());
};

template <class T>
std::vector<T> read_back(const std::filesystem::path& file, OIIO::TypeDesc type, std::vector<std::string>& channels) {
  const auto in = OIIO::ImageInput::open(file.string());
  if (!in) throw std::runtime_error(OIIO::geterror());
  channels = in->spec().channelnames;
  std::vector<T> values(static_cast<std::size_t>(in->spec().width) * in->spec().height * in->spec().nchannels);
  in->read_image(0, 0, 0, -1, type, values.data());
  return values;
}

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(Files, PngHoldsTheSrgbCurve) {
  Image image = filled_image(2, 1, Vec3{0});
  image.pixels = {0, 0.5F, 1, 0.002F, 2, -1};
  write_image(file("a.png"), image);
  std::vector<std::string> channels;
  // 0.5 → 255 (1.055 · 0.5^(1/2.4) − 0.055) = 187.5; 0.002 → 255 · 12.92 · 0.002 = 6.6.
  EXPECT_THAT(read_back<unsigned char>(file("a.png"), OIIO::TypeDesc::UINT8, channels), ElementsAre(0, 188, 255, 7, 255, 0));
  EXPECT_THAT(channels, ElementsAre("R", "G", "B"));
}

TEST_F(Files, ExrHoldsTheNumbersAsTheyAre) {
  const Image steps{.width = 2, .height = 2, .kind = ImageKind::data, .channels = {"steps"}, .pixels = {0, 37.25F, 1e6F, 1}};
  write_image(file("steps.exr"), steps);
  std::vector<std::string> channels;
  EXPECT_EQ(read_back<float>(file("steps.exr"), OIIO::TypeDesc::FLOAT, channels), steps.pixels);
  EXPECT_THAT(channels, ElementsAre("steps"));
}

TEST_F(Files, DataCannotBeShown) {
  const Image steps{.width = 1, .height = 1, .kind = ImageKind::data, .channels = {"steps"}, .pixels = {1}};
  EXPECT_THROW(write_image(file("steps.png"), steps), std::logic_error);
}

TEST_F(Files, OtherExtensionsAreRefused) {
  const std::string expected = "cannot write 'picture.jpg' as an image; expected a name ending in .png or .exr";
  EXPECT_EQ(message_of([] { require_writable_image("picture.jpg"); }), expected);
  EXPECT_EQ(message_of([] { write_image("picture.jpg", filled_image(1, 1, Vec3{0})); }), expected);
  EXPECT_EQ(message_of([] { require_writable_image("picture"); }),
            "cannot write 'picture' as an image; expected a name ending in .png or .exr");
}

TEST_F(Files, AnUnwritablePlaceIsAnErrorThatNamesIt) {
  write_image(file("a.png"), filled_image(1, 1, Vec3{0}));
  const std::filesystem::path below = file("a.png") / "b.png";  // a file where a folder is needed
  EXPECT_THAT(message_of([&] { require_writable_image(below); }), testing::HasSubstr(file("a.png").string()));
  EXPECT_THAT(message_of([&] { write_image(below, filled_image(1, 1, Vec3{0})); }), testing::HasSubstr(file("a.png").string()));
}

TEST(ToneMapping, FollowsTheCurve) {
  Image image = filled_image(1, 1, Vec3{1});
  image.kind = ImageKind::radiance;
  // x = 0.6: 0.6 (2.51 · 0.6 + 0.03) / (0.6 (2.43 · 0.6 + 0.59) + 0.14) = 0.9216 / 1.3688
  EXPECT_THAT(tone_mapped(image).pixels, Each(testing::FloatNear(0.67329F, 1e-4F)));
  EXPECT_THAT(tone_mapped(image, 0).pixels, Each(0.0F));
  EXPECT_THROW((void)tone_mapped(filled_image(1, 1, Vec3{1})), std::logic_error);
}

TEST(SideBySide, PutsImagesInARow) {
  const std::vector<Image> images{filled_image(3, 2, {1, 0, 0}), filled_image(4, 2, {0, 0, 1})};
  const Image row = side_by_side(images, {}, 5);
  EXPECT_EQ(row.width, 3 + 5 + 4);
  EXPECT_EQ(row.height, 2);
  EXPECT_EQ(row.at(2, 1)[0], 1);
  EXPECT_EQ(row.at(2, 1)[2], 0);
  EXPECT_EQ(row.at(3, 1)[1], 1);  // the gap is white
  EXPECT_EQ(row.at(8, 0)[2], 1);
  EXPECT_EQ(row.at(8, 0)[0], 0);
}

TEST(SideBySide, DrawsLabelsAbove) {
  const std::vector<Image> images{filled_image(120, 48, Vec3{1})};
  const std::vector<std::string> labels{"label"};
  const Image row = side_by_side(images, labels);
  EXPECT_GT(row.height, 48);
  float darkest = 1;
  for (const float value : row.pixels) darkest = std::min(darkest, value);
  EXPECT_LT(darkest, 0.3F);
}

TEST(SideBySide, RefusesWhatDoesNotFit) {
  const std::vector<Image> images{filled_image(3, 2, Vec3{1}), filled_image(3, 3, Vec3{1})};
  const std::vector<std::string> labels{"one"};
  EXPECT_THROW((void)side_by_side(images), std::logic_error);
  EXPECT_THROW((void)side_by_side(std::span(images).first(0)), std::logic_error);
  EXPECT_THROW((void)side_by_side(images, labels), std::logic_error);
}

TEST(Text, HasAWidth) { EXPECT_GT(text_width("traversal", 16), text_width("ray", 16)); }

}  // namespace
}  // namespace raystudy
