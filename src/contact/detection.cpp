#include "openclose/contact/detection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "openclose/contact/heirs.h"
#include "openclose/contact/joined_faces.h"
#include "openclose/contact/narrow_phase.h"
#include "openclose/contact/near_blocks.h"
#include "openclose/core/tolerance.h"

namespace openclose {
namespace {

/// Above, an update gives its working memory back when it is done: 0.4 kB a block, more than 1 MB, which costs 0.1 ms to touch again.
constexpr int most_blocks_with_working_memory = 2000;

/// (R(angle) - 1) r; for most angles, which are small, without sines: what the series leave out is below rounding.
Vec2 turned_little_by(double angle, const Vec2& r) {
  constexpr double small = 0.01;  // [rad]; angle^9/9! and angle^8/8! are left out
  if (std::abs(angle) >= small) return Motion::turned_by(angle, r, RotationKind::exact);
  const double q = angle * angle;
  return angle * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0))) * perpendicular(r) - 0.5 * q * (1.0 - q / 12.0 * (1.0 - q / 30.0)) * r;
}

/// Sets JointState::joined and bonded_length of the contacts of a drawing.
void join_faces(const BlockSystem& system, const GroundOutline& ground, std::vector<Contact>& drawn) {
  constexpr double whole = 1.0 - 1e-9;  // [-] what rounding leaves out of a face is none of it
  const double gap = closed_gap * system.median_size();
  for (Contact& c : drawn) {
    if (!c.joint_state.bonded) continue;
    const double joined = joined_at(system, ground, c, gap).length;
    c.joint_state.joined = joined >= whole * c.length ? 1.0 : joined / c.length;
    c.joint_state.bonded_length = c.joint_state.joined * c.length;
  }
}

}  // namespace

Detector::Detector(double reach, const DetectionSkips& skips, InheritedForces forces) : reach_(reach), skips_(skips), forces_(forces) {}

bool Detector::moved_beyond_search_skin(const BlockSystem& system) const {
  for (const std::vector<Unknowns>* then : {&searched_at_, &searched_moving_at_}) {
    if (then->empty()) continue;
    for (int b : system.free_blocks()) {
      const double moved = Motion::displacement_bound(system.displacement(b) - (*then)[b], system.block(b).radius);
      if (moved > 0.5 * skips_.search_skin) return true;
    }
  }
  return false;
}

void Detector::search(const BlockSystem& system) {
  ++counters_.searches;
  shapes_.begin(system);
  std::vector<Box> boxes;
  boxes.reserve(system.block_count());
  searched_at_.resize(system.block_count());
  if (system.resting_blocks().empty())
    searched_moving_at_.clear();
  else if (searched_moving_at_.empty())
    searched_moving_at_ = searched_at_;
  const double room = reach_ + skips_.contact_skin + skips_.search_skin;
  for (int b = 0; b < system.block_count(); ++b) {
    const auto& block = system.block(b);
    searched_at_[b] = system.displacement(b);
    if (!searched_moving_at_.empty() && !system.is_at_rest(b)) searched_moving_at_[b] = system.displacement(b);
    Box box{system.arm(block.first_vertex), system.arm(block.first_vertex)};
    for (int v = block.first_vertex + 1; v < block.first_vertex + block.vertex_count; ++v) {
      box.low = box.low.cwiseMin(system.arm(v));
      box.high = box.high.cwiseMax(system.arm(v));
    }
    boxes.push_back(Box{system.centroid(b) + box.low, system.centroid(b) + box.high}.inflated(0.5 * room));
  }
  const std::vector<std::pair<int, int>> old_pairs = std::move(candidates_.pairs);
  const std::vector<PairState> old_states = std::move(candidates_.states);
  candidates_.pairs = near_blocks(system, boxes, shapes_, room);
  candidates_.states.assign(candidates_.pairs.size(), PairState());
  places_.reserve(system.block_count());
  for (int b = static_cast<int>(places_.size()); b < system.block_count(); ++b) places_.push_back(place(system, b));
  ways_.resize(places_.size());
  for (std::size_t i = 0, old = 0; i < candidates_.pairs.size(); ++i) {
    while (old < old_pairs.size() && old_pairs[old] < candidates_.pairs[i]) ++old;
    if (old < old_pairs.size() && old_pairs[old] == candidates_.pairs[i]) {
      candidates_.states[i] = old_states[old];
      continue;
    }
    // A rotation moves a block's own points where it touches the other, and all of a larger one's surroundings. The boxes of a pair overlap, so that
    // its centroids are never farther apart than this.
    const auto [a, b] = candidates_.pairs[i];
    const double farthest = std::numbers::sqrt2 * (places_[a].radius + places_[b].radius + room + 2.0 * skips_.search_skin);
    const double arm = farthest + std::min(places_[a].radius, places_[b].radius) + reach_ + skips_.contact_skin;
    for (Way* way : {&ways_[a], &ways_[b]}) {
      way->arm = std::max(way->arm, arm);
      way->look_at = way->gone;
    }
  }
  list_pairs_of_blocks(system.block_count());
}

/// Finds the contacts of each pair in the list, which is in the order of the pairs; those whose blocks are no pair any more are gone.
void Detector::locate(const std::vector<Contact>& contacts) {
  const auto pair_of = [](const Contact& c) { return std::pair<int, int>(std::minmax(c.vertex_block, c.edge_block)); };
  candidates_.ranges.resize(candidates_.pairs.size());
  const int count = static_cast<int>(contacts.size());
  int at = 0;
  for (std::size_t i = 0; i < candidates_.pairs.size(); ++i) {
    for (; at < count && pair_of(contacts[at]) < candidates_.pairs[i]; ++at) gone_.push_back(at);
    candidates_.ranges[i].begin = at;
    while (at < count && pair_of(contacts[at]) == candidates_.pairs[i]) ++at;
    candidates_.ranges[i].end = at;
  }
  for (; at < count; ++at) gone_.push_back(at);
}

Detector::Place Detector::place(const BlockSystem& system, int b) {
  const Vec2 centroid = system.centroid(b);
  return {centroid.x(), centroid.y(), Motion::rotation(system.displacement(b)), system.block(b).radius};
}

/// [m] How far points where two blocks can touch may have moved against each other since the pair's contacts were found. With u the displacements of
/// the centroids and R the rotations since then, c the way between the centroids then and r the arm of the point from the centroid of block 1,
/// u_1 - u_2 - (R_2 - 1) c + (R_1 - R_2) r; r is not longer than the radius of block 1, the smaller one, and the reach.
double Detector::relative_way(const PairState& then, const Place& first, const Place& second) const {
  // Which one is the larger is as good as random: chosen from a list, without a branch. Exchanging the blocks turns the sign of the shift only.
  const double turns[] = {first.turn - then.first_turn, second.turn - then.second_turn};
  const double turn_of_larger = turns[first.radius > second.radius ? 0 : 1], radius = std::min(first.radius, second.radius);
  Vec2 shift(first.x - second.x - then.x, first.y - second.y - then.y);
  shift -= turned_little_by(turn_of_larger, {then.x, then.y});
  return (radius + reach_ + skips_.contact_skin) * std::abs(turns[0] - turns[1]) + shift.norm();
}

Detector::Due Detector::due(int pair, double way) const {
  constexpr double companion_part = 0.1;  // of the skin
  const double room = candidates_.states[pair].room;
  // Also where nothing is known of the pair, so that the way is no number.
  if (!std::islessequal(way, room)) return Due::yes;
  // What is out of reach has no history to pass on.
  return room <= skips_.contact_skin && way > companion_part * room ? Due::moved : Due::no;
}

void Detector::list_pairs_of_blocks(int blocks) {
  pairs_of_start_.assign(blocks + 1, 0);
  pairs_of_.resize(2 * candidates_.pairs.size());
  for (const auto& [a, b] : candidates_.pairs) {
    ++pairs_of_start_[a];
    ++pairs_of_start_[b];
  }
  std::partial_sum(pairs_of_start_.begin(), pairs_of_start_.end(), pairs_of_start_.begin());
  for (int i = static_cast<int>(candidates_.pairs.size()) - 1; i >= 0; --i) {  // from the ends, so that each block's pairs come in order
    pairs_of_[--pairs_of_start_[candidates_.pairs[i].first]] = i;
    pairs_of_[--pairs_of_start_[candidates_.pairs[i].second]] = i;
  }
}

/// Adds up the ways of the blocks and finds those whose pairs are to be looked at.
void Detector::follow_blocks(const BlockSystem& system, bool all) {
  restless_.clear();
  is_restless_.assign(system.block_count(), 0);
  for (int b = 0; b < system.block_count(); ++b) {
    const Place now = place(system, b), &before = places_[b];
    Way& way = ways_[b];
    if (now.x != before.x || now.y != before.y || now.turn != before.turn) {
      way.gone += Vec2(now.x - before.x, now.y - before.y).norm() + way.arm * std::abs(now.turn - before.turn);
      places_[b] = now;
    }
    if (!all && way.gone < way.look_at) continue;
    restless_.push_back(b);
    is_restless_[b] = 1;
    way.look_at = std::numeric_limits<double>::infinity();
  }
}

/// Once each.
template <class F>
void Detector::for_pairs_of(const std::vector<int>& blocks, const std::vector<char>& is_among_them, F f) const {
  for (const int b : blocks) {
    for (int k = pairs_of_start_[b]; k < pairs_of_start_[b + 1]; ++k) {
      const auto& [first, second] = candidates_.pairs[pairs_of_[k]];
      if (b == first || !is_among_them[first]) f(pairs_of_[k]);
    }
  }
}

/// A pair in which something has moved by `way` is not due before its blocks have gone what is left of the skin.
void Detector::look_again_before(int pair, double way) {
  const double left = candidates_.states[pair].room - tolerance::rounding_of_ways_m - way;
  for (const int b : {candidates_.pairs[pair].first, candidates_.pairs[pair].second})
    ways_[b].look_at = std::min(ways_[b].look_at, ways_[b].gone + 0.5 * left);
}

bool Detector::mark_due_pairs(const BlockSystem& system, bool all) {
  follow_blocks(system, all || !skips_.looks);
  due_pairs_.clear();
  if (all) {
    due_pairs_.resize(candidates_.pairs.size());
    std::iota(due_pairs_.begin(), due_pairs_.end(), 0);
    return true;
  }
  const auto way = [&](int pair) {
    return relative_way(candidates_.states[pair], places_[candidates_.pairs[pair].first], places_[candidates_.pairs[pair].second]);
  };
  marks_.resize(candidates_.pairs.size());
  long looks = 0;
  for_pairs_of(restless_, is_restless_, [&](int pair) {
    ++looks;
    const double gone = way(pair);
    if (due(pair, gone) == Due::yes) {
      marks_.add(pair);
    } else {
      look_again_before(pair, gone);
    }
  });
  counters_.looks += looks;
  counters_.looks_skipped += static_cast<long>(candidates_.pairs.size()) - looks;
  marks_.take(due_pairs_);
  if (due_pairs_.empty()) return false;
  find_blocks_of_due_pairs();
  for (const int pair : due_pairs_) marks_.add(pair);
  for_pairs_of(in_due_pairs_, in_due_pair_, [&](int pair) {
    if (due(pair, way(pair)) == Due::moved || passes_corners_on(system, pair)) marks_.add(pair);
  });
  marks_.take(due_pairs_);
  return true;
}

/// Whether corners of a block of which a pair is due may pass on to the ground of this pair, or come from there.
bool Detector::passes_corners_on(const BlockSystem& system, int pair) const {
  const auto [a, b] = candidates_.pairs[pair];
  const auto is_free_one_of_due_pair = [&](int block) { return in_due_pair_[block] && system.block(block).equation != BlockSystem::fixed; };
  return (ground_->has_seam(a) && is_free_one_of_due_pair(b)) || (ground_->has_seam(b) && is_free_one_of_due_pair(a));
}

void Detector::find_blocks_of_due_pairs() {
  in_due_pair_.assign(places_.size(), 0);
  in_due_pairs_.clear();
  for (const int i : due_pairs_) {
    for (const int b : {candidates_.pairs[i].first, candidates_.pairs[i].second}) {
      if (!in_due_pair_[b]) in_due_pairs_.push_back(b);
      in_due_pair_[b] = 1;
    }
  }
}

/// Those that share a block with a pair that is due, and these.
const std::vector<int>& Detector::pairs_around_due_ones() {
  find_blocks_of_due_pairs();
  marks_.resize(candidates_.pairs.size());
  for_pairs_of(in_due_pairs_, in_due_pair_, [&](int pair) { marks_.add(pair); });
  marks_.take(around_due_);
  return around_due_;
}

/// Finds the contacts of a pair anew, with the history of those that live on.
void Detector::redo(const JointTable& joints, const BlockSystem& system, int pair, NarrowPhase& narrow, const std::vector<Contact>& before) {
  const auto [a, b] = candidates_.pairs[pair];
  const Range old = candidates_.ranges[pair];
  const std::size_t begin = found_.size();
  index_.select(old);
  narrow.run(a, b, found_);
  lives_on_.assign(old.end - old.begin, 0);
  for (std::size_t k = begin; k < found_.size(); ++k) {
    Contact& c = found_[k];
    c.joint = joints.index(system, c);
    const int known = index_.find(c.vertex, c.edge);
    if (known >= 0) {
      inherit(before[known], stretch_at(before[known], c.gap, moved_by_others_), forces_, c);
      lives_on_[known - old.begin] = 1;
    } else {
      c.joint_state.bonded = first_ && c.gap <= tolerance::deepest_initial_overlap_m;
      if (!first_) rest_at_present_gap(c);
      born_.push_back(k);
    }
  }
  for (int k = old.begin; k < old.end; ++k) {
    if (!lives_on_[k - old.begin]) gone_.push_back(k);
  }
  const bool has_none = old.begin == old.end && begin == found_.size();
  double room = has_none ? std::max(skips_.contact_skin, shapes_.distance_at_least(a, b) - reach_) : skips_.contact_skin;
  for (std::size_t k = begin; k < found_.size(); ++k) {
    // Wider ones cannot close before the pair is due.
    if (found_[k].gap <= skips_.contact_skin) room = std::min(room, narrow.room_before_end(found_[k]));
  }
  candidates_.states[pair] = {places_[a].x - places_[b].x, places_[a].y - places_[b].y, places_[a].turn, places_[b].turn, room};
  look_again_before(pair, 0.0);
  if (!has_none) {
    changes_.push_back({pair, old, {static_cast<int>(begin), static_cast<int>(found_.size())}});
  }
}

void Detector::exchange(Archive& archive) {
  archive(first_, forgotten_, looks_again_, candidates_, resting_, searched_at_, searched_moving_at_, counters_, places_, ways_, pairs_of_start_,
          pairs_of_);
  if (archive.reading()) index_.forget_resting();
}

Memory Detector::memory() const {
  Memory of;
  of.blocks = bytes_of(searched_at_, searched_moving_at_, places_, ways_, pairs_of_start_, restless_, in_due_pairs_, is_restless_, in_due_pair_) +
              shapes_.bytes() + (ground_ ? ground_->bytes() : 0);
  of.contacts = bytes_of(candidates_.pairs, candidates_.states, candidates_.ranges, pairs_of_, changes_, due_pairs_, around_due_, found_, kept_,
                         lives_on_, born_, gone_) +
                bytes_of(resting_.pairs, resting_.states, resting_.ranges) + index_.bytes() + marks_.bytes();
  return of;
}

void Detector::let_go_of_working_memory() {
  shapes_.let_go();
  for (std::vector<int>* list : {&restless_, &in_due_pairs_, &due_pairs_, &around_due_, &gone_}) std::vector<int>().swap(*list);
  std::vector<std::size_t>().swap(born_);
  std::vector<Run>().swap(kept_);
}

bool Detector::update(const BlockSystem& system, const JointTable& joints, ContactSet& contacts, const BlockSystem* present) {
  std::vector<Contact>& moving = contacts.moving;
  const bool all = std::exchange(looks_again_, false) || forgotten_ || !skips_.search || !skips_.narrow_phase;
  const bool searches = needs_search(system);
  moved_by_others_ = std::exchange(forgotten_, false);
  if (!ground_) ground_ = std::make_shared<GroundOutline>(system);
  born_.clear();
  gone_.clear();
  changes_.clear();
  if (system.block_count() > most_blocks_with_working_memory) std::vector<DetectionChange>().swap(changes_);  // the first ones are all
  if (searches) {
    search(system);
    locate(moving);
  } else {
    ++counters_.searches_skipped;
  }
  if (!mark_due_pairs(system, all) && !searches) {
    counters_.narrow_phases_skipped += static_cast<long>(candidates_.pairs.size());
    return false;
  }
  counters_.narrow_phases += static_cast<long>(due_pairs_.size());
  counters_.narrow_phases_skipped += static_cast<long>(candidates_.pairs.size() - due_pairs_.size());
  const bool orphans = !gone_.empty();
  if (!searches) shapes_.begin(system);
  index_.begin(system, moving, contacts.resting);
  for (const int pair : pairs_around_due_ones()) index_.add(candidates_.ranges[pair]);
  const Neighbours neighbours(candidates_.pairs, pairs_of_start_, pairs_of_);
  NarrowPhase narrow(system, present, reach_ + skips_.contact_skin, first_, shapes_, index_, neighbours, *ground_);
  for (const int pair : due_pairs_) redo(joints, system, pair, narrow, moving);
  if (first_) join_faces(system, *ground_, found_);
  if (!first_) counters_.transfers += pass_on_history(system, moving, gone_, found_, born_, forces_);
  put_in_place(moving, orphans);
  if (due_pairs_.size() == candidates_.pairs.size()) index_.let_go();  // later ones are few
  if (system.block_count() > most_blocks_with_working_memory) let_go_of_working_memory();
  first_ = false;
  return true;
}

}  // namespace openclose
