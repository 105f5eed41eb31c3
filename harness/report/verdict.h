#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/report/published.h"
#include "harness/report/statistics.h"
#include "harness/spec/target.h"

namespace raystudy {

/// How our number stands to the published one. match: within the tolerance stated with the published value. trend: not that, but
/// the order of the methods and the sign of each change are the published ones. differs: neither. not_comparable: what was
/// measured is not the same thing (scene variant, hardware). reached, missed: of a target, by the median. none: nothing is
/// published and there is no target, or we have no number.
enum class Verdict : unsigned char { none, match, trend, differs, not_comparable, reached, missed };
[[nodiscard]] std::string_view verdict_name(Verdict verdict);

/// Another method's pair of numbers of the same quantity on the same scene, which the order is judged against.
struct Peer {
  double published = 0;
  Estimate ours;
};

struct Judgement {
  Verdict verdict = Verdict::none;
  std::string reason;  ///< empty for a plain match
};

/// Judges `ours`, in the published unit. `scene` is null where the values do not belong to a scene of the paper. `peers` are the
/// other methods of the row; a relative column's baseline counts as one more. Rules, in this order:
/// 1. A column compared by nothing, or on a scene variant a column without baseline, is not comparable.
/// 2. Compared by value, and not on a scene variant: `match` within the tolerance (of the median; its interval plays no part).
/// 3. `trend`, if for every peer whose published value is another, ours lies on the published side of the peer's. Where both have
///    intervals, these must not overlap: an order that the noise could turn is not shown. At least one such peer is needed.
/// 4. Else `differs`; but where only the direction is compared and there is no peer, not comparable.
[[nodiscard]] Judgement judge(const PublishedColumn& column, const PublishedScene* scene, double published, const Estimate& ours,
                              const std::vector<Peer>& peers);

/// Whether the median meets the target, in the unit shown; the reason says where the interval leaves that open.
[[nodiscard]] Judgement judge(const Target& target, const Estimate& ours);

/// "first; second"; one alone where the other is empty.
[[nodiscard]] std::string joined(const std::string& first, const std::string& second);

}  // namespace raystudy
