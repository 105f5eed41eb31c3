#include "harness/report/label_layout.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace raystudy {
namespace {

const LabelStyle style{520, 380, 11, 6};

struct Box {
  double left, top, right, bottom;
  [[nodiscard]] bool meets(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

Box box_of(const PlacedLabel& placed, const std::string& text) {
  return {placed.left.x, placed.left.y - 5.5, placed.left.x + text_width(text, style.font_size), placed.left.y + 5.5};
}

TEST(LabelLayout, OneLabelStandsRightOfItsPoint) {
  const std::vector<PlacedLabel> placed = place_labels({{{100, 100}, "sweep"}}, {}, style);
  EXPECT_NEAR(placed.at(0).left.x, 109, 1e-9);
  EXPECT_NEAR(placed.at(0).left.y, 100, 1e-9);
  EXPECT_FALSE(placed.at(0).has_line);
}

TEST(LabelLayout, StaysWithinThePanel) {
  for (const PanelPoint corner : {PanelPoint{515, 5}, {515, 375}, {5, 5}, {5, 375}}) {
    const std::string text = "a long name of a method";
    const Box box = box_of(place_labels({{corner, text}}, {}, style).at(0), text);
    EXPECT_GE(box.left, 0);
    EXPECT_LE(box.right, style.width);
    EXPECT_GE(box.top, 0);
    EXPECT_LE(box.bottom, style.height);
  }
}

TEST(LabelLayout, LabelsOfACrowdOverlapNeitherEachOtherNorPoints) {
  std::mt19937 random(1);
  std::vector<LabelRequest> requests;
  for (int i = 0; i < 12; ++i) {
    const double x = 200 + static_cast<double>(random() % 60);
    const double y = 150 + static_cast<double>(random() % 60);
    requests.push_back({{x, y}, fmt::format("a-method-{}", i)});
  }
  const std::vector<PlacedLabel> placed = place_labels(requests, {}, style);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Box box = box_of(placed[i], requests[i].text);
    for (std::size_t j = 0; j < placed.size(); ++j) {
      const PanelPoint p = requests[j].point;
      EXPECT_FALSE(box.meets({p.x - 5, p.y - 5, p.x + 5, p.y + 5})) << i << " over point " << j;
      if (i == j) continue;
      EXPECT_FALSE(box.meets(box_of(placed[j], requests[j].text))) << i << " over label " << j;
    }
    if (!placed[i].has_line) continue;
    EXPECT_LT(std::hypot(placed[i].from.x - requests[i].point.x, placed[i].from.y - requests[i].point.y), 8);
  }
}

TEST(LabelLayout, KeepsOffTheCurve) {
  const std::vector<PanelPoint> curve{{100, 100}, {300, 100}};
  const Box box = box_of(place_labels({{{100, 100}, "front"}}, curve, style).at(0), "front");
  EXPECT_TRUE(box.bottom < 100 || box.top > 100 || box.right < 100);
}

TEST(LabelLayout, WidthsOfTexts) {
  EXPECT_EQ(text_width("", 11), 0);
  EXPECT_LT(text_width("ill", 11), text_width("bcd", 11));
  EXPECT_LT(text_width("bcd", 11), text_width("mmm", 11));
  EXPECT_EQ(text_width("\u00e9", 11), text_width("e", 11)) << "a letter of two bytes is one";
}

}  // namespace
}  // namespace raystudy
