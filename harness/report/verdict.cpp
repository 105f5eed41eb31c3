#include "harness/report/verdict.h"

#include <fmt/format.h>

#include <algorithm>

namespace raystudy {
namespace {

Estimate::Interval bounds(const Estimate& e) { return e.interval.value_or(Estimate::Interval{e.value, e.value}); }

enum class Order : unsigned char { kept, turned, unsettled };

/// Whether ours lie in the order of the published values.
Order compare(double published, const Estimate& ours, const Peer& peer) {
  const bool above = published > peer.published;
  const Estimate::Interval mine = bounds(ours);
  const Estimate::Interval other = bounds(peer.ours);
  if (above ? mine.low > other.high : mine.high < other.low) return Order::kept;
  return (above ? ours.value > peer.ours.value : ours.value < peer.ours.value) ? Order::unsettled : Order::turned;
}

}  // namespace

std::string joined(const std::string& first, const std::string& second) {
  if (first.empty() || second.empty()) return first + second;
  return first + "; " + second;
}

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::match: return "match";
    case Verdict::trend: return "trend";
    case Verdict::differs: return "differs";
    case Verdict::not_comparable: return "not comparable";
    case Verdict::reached: return "reached";
    case Verdict::missed: return "missed";
    case Verdict::none: break;
  }
  return "";
}

Judgement judge(const PublishedColumn& column, const PublishedScene* scene, double published, const Estimate& ours,
                const std::vector<Peer>& peers) {
  const Comparability comparability = scene == nullptr ? Comparability::same : scene->comparability;
  const bool is_variant = comparability == Comparability::variant || comparability == Comparability::unverified;
  const std::string variant = is_variant ? "scene variant: " + scene->reason : "";
  const std::string close = comparability == Comparability::close_variant ? "close variant of the scene: " + scene->reason : "";

  if (column.compared_by == ComparedBy::nothing) return {Verdict::not_comparable, column.reason};
  if (is_variant && !column.baseline) return {Verdict::not_comparable, variant};
  const bool by_value = column.compared_by == ComparedBy::value && !is_variant;
  if (by_value && column.tolerance.accepts(published, ours.value)) return {Verdict::match, close};

  std::vector<Peer> all = peers;
  if (column.baseline) all.push_back({*column.baseline, {*column.baseline, {}}});
  std::erase_if(all, [&](const Peer& peer) { return peer.published == published; });
  std::string why = by_value ? fmt::format("outside the tolerance of {}", column.tolerance.text(column.unit))
                             : fmt::format("only the direction is compared: {}", joined(variant, column.reason));
  why = joined(why, close);
  if (all.empty()) {
    return {by_value ? Verdict::differs : Verdict::not_comparable,
            joined(why, "no other method's value to compare the order with")};
  }
  const auto any = [&](Order order) {
    return std::any_of(all.begin(), all.end(), [&](const Peer& peer) { return compare(published, ours, peer) == order; });
  };
  if (any(Order::turned)) return {Verdict::differs, joined(why, "the order of the methods or the sign of the change is another")};
  if (any(Order::unsettled)) return {Verdict::differs, joined(why, "the noise leaves the order or the sign of the change open")};
  return {Verdict::trend, why};
}

Judgement judge(const Target& target, const Estimate& ours) {
  const Verdict verdict = target.is_met_by(ours.value) ? Verdict::reached : Verdict::missed;
  const Estimate::Interval interval = bounds(ours);
  const bool is_settled = target.is_met_by(interval.low) == target.is_met_by(interval.high);
  return {verdict, is_settled ? "" : "the interval reaches across the target"};
}

}  // namespace raystudy
