#include "app/estimate/field_samples.hpp"

#include "core/base/index.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fascia::app {
namespace {

constexpr std::size_t kMostPlaces = 200;  // of a body
constexpr double kOn = 1e-9;              // of its size: what is nearer is on it

bool carries_field(const Scene& scene, const std::string& name) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const Body& b) { return b.name == name && !is_carrier(b); });
}

}  // namespace

FieldSamples::FieldSamples(const Simulation& s, const Simulation* coarser) : prefix_("fascia_field_") {
  const auto taken = [&](const Probe& p) { return p.name.starts_with(prefix_); };
  while (std::any_of(s.scene.probes.begin(), s.scene.probes.end(), taken)) prefix_ += "_";
  for (std::size_t b = 0; b < s.bodies.size(); ++b) {
    const SimulatedBody& body = s.bodies[b];
    if (!carries_field(s.scene, body.name)) continue;
    Samples samples;
    samples.name = body.name;
    const Simulation& from = coarser ? *coarser : s;
    const SimulatedBody& coarse = from.bodies[b];
    std::vector<std::size_t> chosen;
    const std::size_t stride = 1 + coarse.nodes.size() / (4 * kMostPlaces);
    for (std::size_t i = 0; i < coarse.nodes.size(); i += stride) {
      const Vec3d& X = coarse.nodes[i];
      if (body.body->distance(X) <= kOn * body.body->size() && coarse.body->distance(X) <= kOn * body.body->size())
        chosen.push_back(i);
    }
    double mass = 0;
    const std::size_t places = std::min(chosen.size(), kMostPlaces);
    for (std::size_t k = 0; k < places; ++k) {
      const std::size_t i = chosen[k * chosen.size() / places];
      samples.X.push_back(coarse.nodes[i]);
      samples.places.push_back(body.body->attach(coarse.nodes[i]));
      samples.weight.push_back(from.model.inertia[at(coarse.node_ids[i])].mass);
      mass += samples.weight.back();
    }
    if (places == 0) continue;
    for (double& w : samples.weight) w = std::sqrt(mass > 0 ? w / mass : 1.0 / static_cast<double>(places));
    bodies_.push_back(std::move(samples));
  }
}

void FieldSamples::add(double time, const State& state) {
  for (Samples& body : bodies_) {
    std::vector<double> values;
    for (std::size_t i = 0; i < body.places.size(); ++i) {
      const Vec3d u = field_at(body.places[i], state).u;
      for (int a = 0; a < 3; ++a) values.push_back(body.weight[i] * u[a]);
    }
    body.series.times.push_back(time);
    body.series.values.push_back(std::move(values));
  }
}

std::string FieldSamples::probe(std::size_t i) const { return fmt::format("{}{}", prefix_, i); }

std::string FieldSamples::override_for(std::size_t i) const {
  std::string places;
  for (const Vec3d& X : bodies_[i].X)
    places += fmt::format("{}[{:.17g}, {:.17g}, {:.17g}]", places.empty() ? "" : ", ", X[0], X[1], X[2]);
  return fmt::format("probes.{}={{ body = {}, quantity = \"displacement\", at = [{}] }}", probe(i),
                     nlohmann::json(bodies_[i].name).dump(), places);
}

Series FieldSamples::series(std::size_t i, bool over_time) const {
  const Series& all = bodies_[i].series;
  if (over_time || all.times.empty()) return all;
  return {{1}, {all.values.back()}};
}

Series FieldSamples::weighted(std::size_t i, Series series) const {
  for (std::vector<double>& values : series.values)
    for (std::size_t k = 0; k < values.size() && k / 3 < bodies_[i].weight.size(); ++k)
      values[k] *= bodies_[i].weight[k / 3];
  return series;
}

}  // namespace fascia::app
