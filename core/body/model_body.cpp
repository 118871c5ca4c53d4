#include "core/body/model_body.hpp"

#include "core/base/index.hpp"
#include "core/base/throwing_loops.hpp"
#include "core/physics/element_law.hpp"

#include <algorithm>

namespace fascia {

namespace {

/// The point's material as the mechanics use it, without stabilisation and damping.
ThinMaterial<double> stress_material(const BodyPoint& p, const Mat3d& axes) {
  const Lame lame = thin_lame(p.law, lasting_constants(p));
  ThinMaterial<double> m{};
  m.volume = p.volume;
  m.lambda = lame.lambda;
  m.mu = lame.mu;
  m.law = p.law;
  m.axes = axes;
  m.transverse = p.transverse;
  return m;
}

Mat3d cauchy(const Mat3d& F, const Mat3d& S) { return times_transpose(F * S, F) * (1 / determinant(F)); }

/// @param Hv  where the volumetric strain is taken; H without selective integration
/// @param past, past_v  what the point remembers or makes by itself, and remembers of its volumetric strain
PointTensors tensors_of(const BodyPoint& p, const std::vector<Mat3d>& axes, const Mat3d& H, const Mat3d& Hv,
                        const RememberedStress& past, const RememberedStress& past_v, bool selective) {
  const Mat3d E = green_strain(H), F = Mat3d::identity() + H, Fv = Mat3d::identity() + Hv;
  if (is_thin(p.law)) {
    const ThinMaterial<double> m = stress_material(p, axes[at(p.axes)]);
    const Mat3d S = second_piola(m, E);
    const double lasting = p.viscosity ? p.viscosity->long_term() : 1.0;
    return {E, cauchy(F, S + past.at(S * (1 / lasting)) + past.active), energy_density(m, E)};
  }
  return with_solid_law(p.law, [&]<Law L>() -> PointTensors {
    LawConstants without_lambda = p, lambda_alone = p;
    without_lambda.lambda = lambda_alone.mu = 0;
    std::fill(lambda_alone.own.begin(), lambda_alone.own.end(), 0.0);
    const auto law = [](const LawConstants& constants) { return make_law<SolidLaw<L, double>>(constants); };
    const auto shear = law(lasting_constants(without_lambda)), volume = law(lasting_constants(lambda_alone));
    Mat3d S = second_piola(shear, H), Sv = second_piola(volume, Hv);
    if (p.viscosity) {
      // Without a volumetric lane the point remembers both.
      const Mat3d S_e = second_piola(law(relaxing_constants(without_lambda)), H),
                  S_ev = second_piola(law(relaxing_constants(lambda_alone)), Hv);
      S += selective ? past.at(S_e) : past.at(S_e + S_ev);
      if (selective) Sv += past_v.at(S_ev);
    }
    return {E, cauchy(F, S + past.active) + cauchy(Fv, Sv), energy_density(shear, H) + energy_density(volume, Hv)};
  });
}

}  // namespace

FieldValue field_at(const Attachment& a, const State& state) {
  FieldValue f;
  for (std::size_t k = 0; k < a.nodes.size(); ++k) {
    const Influence& i = a.influences[k];
    const Vec3d& u = state.u[at(a.nodes[k])];
    const Mat3d& D = state.D[at(a.nodes[k])];
    f.u += u * i.w + D * i.b;
    f.D += D * i.w;
    f.H += outer(u, i.g) + D * i.B;
  }
  return f;
}

std::vector<std::vector<int>> ModelBody::faces() const {
  std::vector<std::vector<int>> faces;
  for (const auto& t : surface_.triangles) faces.push_back({t.begin(), t.end()});
  return faces;
}

std::vector<FacePoint> ModelBody::face_points() const {
  std::vector<FacePoint> points;
  for (const auto& t : surface_.triangles) {
    const Vec3d &a = surface_.points[at(t[0])], &b = surface_.points[at(t[1])], &c = surface_.points[at(t[2])];
    const double area = 0.5 * norm(cross(b - a, c - a));
    for (const Vec3d& X : {(a * 4.0 + b + c) * (1.0 / 6), (a + b * 4.0 + c) * (1.0 / 6), (a + b + c * 4.0) * (1.0 / 6)})
      points.push_back({X, area / 3, attach(X), {t[0], t[1], t[2]}});
  }
  return points;
}

std::vector<Mat3d> ModelBody::gradients(const State& state) const {
  std::vector<Mat3d> all;
  all.reserve(points_.size());
  for (std::size_t q = 0; q < points_.size(); ++q) all.push_back(field_at(attach_point(q), state).H);
  return all;
}

std::vector<PointTensors> ModelBody::tensors(const State& state) const {
  ThreadPool alone(1);
  return tensors(state, alone);
}

std::vector<PointTensors> ModelBody::tensors(const State& state, ThreadPool& pool) const {
  std::vector<PointTensors> all(points_.size());
  store_tensors(state, pool, all);
  return all;
}

void ModelBody::store_tensors(const State& state, ThreadPool& pool, std::span<PointTensors> out) const {
  constexpr int kGrain = 256;
  for_throwing_ranges(pool, static_cast<int>(out.size()), kGrain, [&](int begin, int end) {
    for (std::size_t q = at(begin); q < at(end); ++q) out[q] = tensors_at(attach_point(q), q, state);
  });
}

TensorField ModelBody::tensor_field(const State& state) const {
  return [this, &state](const Attachment& place, std::size_t nearest) { return tensors_at(place, nearest, state); };
}

PointTensors ModelBody::tensors_at(const Attachment& place, std::size_t nearest, const State& state) const {
  const Mat3d H = field_at(place, state).H;
  const Mat3d Hv = selective() ? field_at(attach_volumetric(place), state).H : H;
  return tensors_of(points_[nearest], axes_, H, Hv, remembered(nearest, state), remembered_volumetric(nearest, state),
                    selective());
}

LawConstants lasting_constants(LawConstants constants) {
  if (constants.viscosity == nullptr) return constants;
  const double lasting = constants.viscosity->long_term();
  scale_constants(LawFactors<double>{lasting, constants.viscosity->shear_only ? 1 : lasting}, constants);
  return constants;
}

LawConstants relaxing_constants(LawConstants constants) {
  if (constants.viscosity != nullptr && constants.viscosity->shear_only)
    scale_constants(LawFactors<double>{1, 0}, constants);
  return constants;
}

double largest_poisson(const LawConstants& constants) {
  return std::max(constants.poisson(), lasting_constants(constants).poisson());
}

Mat3d RememberedStress::at(const Mat3d& S_e) const {
  const Mat3d difference = S_e - fading;
  const double size = norm(fading), apart = norm(difference);
  if (!(size > 0) || !(apart > 0)) return left;
  const double most = (norm(left) + share * apart) / apart;
  return left + difference * std::clamp(contract(left, fading * (1 / size)) / size, -most, most);
}

double ModelBody::branch_sum(std::size_t lane, int row, const State& state) const {
  double sum = 0;
  for (std::size_t first = memory_stride_; first < state.memory.size(); first += memory_stride_)
    sum += state.memory[first + MemoryLayout::place(lane, 6, row)];
  return sum;
}

RememberedStress ModelBody::remembered_at(const std::vector<std::size_t>& lanes, std::size_t point,
                                          const State& state) const {
  RememberedStress past;
  if (points_[point].viscosity) past.share = 1 - points_[point].viscosity->long_term();
  if (lanes.empty() || lanes[point] == kNoLane || state.memory.empty()) return past;
  for (int c = 0; c < 6; ++c) {
    const auto [i, j] = kSymmetricPlaces[c];
    past.fading(i, j) = past.fading(j, i) = state.memory[MemoryLayout::place(lanes[point], 6, c)];
    past.left(i, j) = past.left(j, i) = branch_sum(lanes[point], c, state);
  }
  return past;
}

RememberedStress ModelBody::remembered(std::size_t point, const State& state) const {
  RememberedStress past = remembered_at(memory_lane_, point, state);
  const auto& active = points_[point].active;
  if (active && !state.factors.empty()) past.active = active->S * state.factors[at(active->schedule)];
  return past;
}

void ModelBody::find_memories(const PointSet& set) {
  memory_stride_ = set.memory.lanes() * 6;
  if (std::none_of(points_.begin(), points_.end(), [](const BodyPoint& p) { return p.viscosity != nullptr; })) return;
  memory_lane_.assign(points_.size(), kNoLane);
  if (!set.source.empty()) find_lanes_of_points(set);
  find_lanes_of_elements(set);
}

void ModelBody::find_lanes_of_points(const PointSet& set) {
  std::vector<std::size_t> since_volumetric;
  for (std::size_t lane = at(blocks.groups.first) * kGroupSize; lane < at(blocks.groups.end()) * kGroupSize; ++lane) {
    const int source = set.source[lane];
    if (source >= 0) {
      memory_lane_[at(source)] = lane;
      since_volumetric.push_back(at(source));
    } else if (source == PointSample::kVolumetric) {
      volumetric_lane_.resize(points_.size(), kNoLane);
      for (const std::size_t point : since_volumetric) volumetric_lane_[point] = lane;
      since_volumetric.clear();
    }
  }
}

void ModelBody::find_lanes_of_elements(const PointSet& set) {
  const std::vector<std::size_t>& begin = set.memory.begin;  // of the groups of points, of elements, of shells
  blocks.elements.for_each([&](std::size_t b) {
    const ElementBlock& block = set.blocks[b];
    for (int e = 0; e < block.count && !block.beside.empty(); ++e)
      for (int q = 0; q < block.points; ++q)
        memory_lane_[at(block.source[at(e)] * block.points + q)] =
            begin[1 + b] + at((e / kElementLanes * block.points + q) * kElementLanes + e % kElementLanes);
  });
  blocks.shells.for_each([&](std::size_t b) {
    const ShellBlock& shell = set.shells[b];
    for (int t = 0; t < shell.count && !shell.viscosity.empty(); ++t)
      memory_lane_[at(shell.source[at(t)])] = begin[1 + set.blocks.size() + b] + ShellBlock::memory_lane(t);
  });
}

Mat3d ModelBody::strain_at(const Attachment& place, const State& state) const {
  return green_strain(field_at(place, state).H);
}

}  // namespace fascia
