#include "app/explain/report.hpp"
#include "app/machine.hpp"

namespace fascia::app {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Ratio& r) { return {{"median", r.median}, {"low", r.low}, {"high", r.high}}; }

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

const char* name_of(VariantKind kind) {
  switch (kind) {
    case VariantKind::left_out:
      return "left out";
    case VariantKind::rigid:
      return "rigid";
    case VariantKind::formulation:
      return "formulation";
    case VariantKind::law:
      return "law";
    case VariantKind::order:
      return "order";
    case VariantKind::frame_kind:
      return "kind of frames";
    case VariantKind::coarser:
      return "coarser";
    case VariantKind::fluid:
      return "fluid";
    case VariantKind::damping:
      return "damping";
    case VariantKind::viscosity:
      return "viscosity";
    case VariantKind::coupling:
      return "coupling";
    case VariantKind::newton_tolerance:
      return "Newton tolerance";
    case VariantKind::linear_tolerance:
      return "linear tolerance";
    case VariantKind::linear_solver:
      return "linear solver";
    case VariantKind::tangent:
      return "tangent";
    case VariantKind::precision:
      return "precision";
    case VariantKind::backend:
      return "backend";
    case VariantKind::threads:
      return "threads";
    case VariantKind::time_step:
      return "time step";
  }
  return "";
}

Json stages_json(const Stages& s) {
  return {{"seconds", {{"start", s.start}, {"setup", s.setup}, {"solve", s.solve}, {"output", s.output}}},
          {"memory_bytes", {{"start", s.memory_start}, {"setup", s.memory_setup}, {"solve", s.memory_run}}}};
}

Json body_json(const BodyProfile& b) {
  Json j{{"model", b.model},
         {"unknowns", b.unknowns},
         {"points", b.points},
         {"cells", b.cells},
         {"mass", b.mass},
         {"time_share", {{"value", b.time.value}, {"estimated", b.time.estimated}, {"how", b.time.how}}},
         {"memory_share", optional_json(b.memory)}};
  if (b.motion)
    j["motion"] = {{"rotation", b.motion->rotation},
                   {"strain", optional_json(b.motion->strain)},
                   {"deformation", b.motion->deformation},
                   {"displacement", b.motion->displacement}};
  return j;
}

Json part_json(const Explanation& e, const Part& part) {
  const Variant& v = part.variant;
  Json j{{"kind", name_of(v.kind)}, {"part", v.part}, {"change", v.change}, {"set", v.overrides}, {"closer", v.closer}};
  j["status"] = !v.refused.empty() ? "refused" : part.record ? part.record->status : e.quick ? "estimated" : "not run";
  j["reason"] = !v.refused.empty() ? v.refused : part.record ? part.record->reason : "";
  if (e.quick && part.estimated_change) {
    j["estimated_gain"] = part.estimated_gain;
    j["estimated_change"] = *part.estimated_change;
  }
  if (!part.measured()) return j;
  j["solve"] = json_of(part.solve);
  j["setup"] = json_of(part.setup);
  j["memory"] = part.memory;
  j["changes"] = Json::object();
  for (const ProbeChange& c : part.changes) j["changes"][c.probe] = optional_json(c.relative);
  j["record"] = app::json_of(*part.record);
  return j;
}

Json suggestion_json(const Suggestion& s) {
  Json j{{"text", s.text}, {"set", s.overrides}, {"solve", json_of(s.solve)}, {"estimated", s.estimated}};
  if (s.change) j["largest_change"] = {{"probe", s.change->probe}, {"relative", optional_json(s.change->relative)}};
  j["carried_out_together"] = s.carried_out;
  return j;
}

}  // namespace

Json json_of(const Explanation& e) {
  const Machine m = this_machine();
  Json j{{"fascia_explain", 1},
         {"scene", e.scene.path.string()},
         {"set", e.overrides},
         {"quick", e.quick},
         {"interrupted", e.interrupted},
         {"limit", e.limit},
         {"seconds", e.seconds},
         {"machine",
          {{"date", m.date}, {"cpu", m.cpu}, {"threads", m.threads}, {"fascia", m.fascia}, {"commit", m.commit}}},
         {"base", json_of(e.base)},
         {"stages", stages_json(e.stages)}};
  j["bodies"] = Json::object();
  for (const BodyProfile& b : e.bodies) j["bodies"][b.name] = body_json(b);
  j["parts"] = Json::array();
  for (const Part& part : e.parts) j["parts"].push_back(part_json(e, part));
  j["suggestions"] = Json::array();
  for (const Suggestion& s : e.suggestions) j["suggestions"].push_back(suggestion_json(s));
  j["together"] = e.together ? suggestion_json(*e.together) : Json(nullptr);
  j["notes"] = e.notes;
  return j;
}

}  // namespace fascia::app
