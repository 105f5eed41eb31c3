#include "methods/insertion/candidates.h"

#include <gmock/gmock.h>

#include "harness/method/pair_measure.h"
#include "methods/insertion/tree_edit.h"
#include "tests/support/trees.h"

namespace raystudy::insertion {
namespace {

const SurfaceArea area;
const auto every = [](Candidate) { return true; };

using test::bar;

/// root (P, C), P (A, B): records 1 and 2; C stands at slot 3, A at 4, B at 5.
PairTree three_bars() {
  Bvh2 bvh;
  bvh.nodes = {{bar(0, 9), 2, 0}, {}, {bar(0, 5), 4, 0}, {bar(8, 9), 0, 1}, {bar(0, 1), 1, 1}, {bar(3, 5), 2, 1}};
  bvh.triangles = {0, 1, 2};
  PairTree tree(bvh);
  measure_all(tree, area);
  return tree;
}

std::vector<std::uint32_t> ids(const std::vector<Candidate>& list) {
  std::vector<std::uint32_t> all;
  all.reserve(list.size());
  for (const Candidate c : list) all.push_back(c.id());
  return all;
}

TEST(Candidates, RankByWhatTheyCouldGain) {
  const PairTree tree = three_bars();  // half areas: root 19, P 11, C 3, A 3, B 5
  Candidates candidates(tree, Ranking::potential, true);
  const std::uint32_t children_of_p = Candidate::children_of(2).id();
  // Both of P's children: 19 + 11 - 3 - 5 = 22; C: 19 - 3; P: 19 - 11 = 8 and A: 11 - 3 = 8, the later slot first; B: 11 - 5.
  EXPECT_THAT(ids(candidates.all(every)), testing::ElementsAre(children_of_p, 3, 4, 2, 5));
}

TEST(Candidates, RankByArea) {
  const PairTree tree = three_bars();
  EXPECT_THAT(ids(Candidates(tree, Ranking::area, false).all(every)), testing::ElementsAre(2, 5, 4, 3));
  EXPECT_THAT(ids(Candidates(tree, Ranking::none, false).all(every)), testing::ElementsAre(5, 4, 3, 2));
}

TEST(Candidates, AreLimitedToAShareOfEachKind) {
  const Scene scene = test::scene_of(test::random_boxes(1000, 1));
  PairTree tree(test::random_tree(scene, 1));
  measure_all(tree, area);
  Candidates candidates(tree, Ranking::potential, true);
  const std::vector<std::uint32_t> all = ids(candidates.all(every));
  EXPECT_EQ(all.size(), 1998U + 998U);
  for (const double share : {0.01, 0.1, 0.5}) {
    candidates.limit_to(share);
    const std::vector<Candidate>& some = candidates.all(every);
    const auto nodes = std::count_if(some.begin(), some.end(), [](Candidate c) { return c.is_node(); });
    EXPECT_NEAR(static_cast<double>(nodes), share * 1998, 0.02 * 1998);
    EXPECT_GE(static_cast<double>(nodes), share * 1998);
    EXPECT_NEAR(static_cast<double>(some.size()) - static_cast<double>(nodes), share * 998, 0.02 * 998);
  }
  candidates.limit_to(1);
  EXPECT_EQ(ids(candidates.all(every)), all);
}

TEST(Candidates, OfSomeRecordsAndFiltered) {
  const PairTree tree = three_bars();
  Candidates candidates(tree, Ranking::potential, true);
  EXPECT_THAT(ids(candidates.in({2}, [](Candidate c) { return c.is_node(); })), testing::ElementsAre(4, 5));
  EXPECT_THAT(ids(candidates.in({}, every)), testing::IsEmpty());
}

TEST(Activity, IsWhatHasChangedSinceItSettled) {
  const PairTree tree = three_bars();
  Activity activity(tree);
  const auto a = Candidate::node_at(4);
  const auto both = Candidate::children_of(2);
  EXPECT_TRUE(activity.is_active(a));
  activity.settle(a);
  activity.settle(both);
  EXPECT_FALSE(activity.is_active(a));
  EXPECT_TRUE(activity.is_active(Candidate::node_at(5)));
  std::vector<std::uint32_t> raised;
  activity.take_raised(raised);
  EXPECT_THAT(raised, testing::IsEmpty());
  activity.changed(1);  // P's box: for P's children together there is something new, not for each alone
  EXPECT_FALSE(activity.is_active(a));
  EXPECT_TRUE(activity.is_active(both));
  activity.take_raised(raised);
  EXPECT_THAT(raised, testing::UnorderedElementsAre(1, 2));
  activity.changed(2);
  EXPECT_TRUE(activity.is_active(a));
  activity.take_raised(raised);
  EXPECT_THAT(raised, testing::ElementsAre(2));
}

TEST(TreeEdit, TellsOfEveryRecordThatChanges) {
  struct Watch {
    std::vector<bool>* seen;
    void changed(std::uint32_t record) const { (*seen)[record] = true; }
  };
  const Scene scene = test::scene_of(test::random_boxes(100, 1));
  PairTree tree(test::random_tree(scene, 1));
  std::vector<bool> seen;
  TreeEdit<SurfaceArea, PairTree, Watch> edit(tree, area, Watch{&seen});
  for (std::uint32_t n = 1; n <= tree.inner_count(); ++n) {
    if (n == tree.root()) continue;
    const PairTree before = tree;
    seen.assign(tree.pairs.size(), false);
    const auto removed = edit.remove(n);
    edit.insert(removed.nodes[0], tree.up[tree.root()], removed.free[0]);
    edit.insert(removed.nodes[1], removed.old_slot, removed.free[1]);
    for (std::uint32_t p = 0; p < tree.pairs.size(); ++p) {
      const bool changed = before.pairs[p].link != tree.pairs[p].link ||
                           !(before.pairs[p].boxes.box(0) == tree.pairs[p].boxes.box(0)) ||
                           !(before.pairs[p].boxes.box(1) == tree.pairs[p].boxes.box(1));
      EXPECT_TRUE(!changed || seen[p]) << "node " << n << ", record " << p;
    }
  }
}

}  // namespace
}  // namespace raystudy::insertion
