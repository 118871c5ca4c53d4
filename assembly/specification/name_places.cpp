#include "assembly/specification/check.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

namespace fascia {

namespace {

void name_place(Place& place, std::string key) {
  if (place.file.empty() && place.key.empty()) place.key = std::move(key);
}

void name_region(Region& region, const std::string& key) {
  name_place(region.place, key);
  if (auto* no = std::get_if<NotRegion>(&region.shape); no && no->part) {
    Region part = *no->part;
    name_region(part, key);
    no->part = std::make_shared<const Region>(std::move(part));
  }
  if (auto* all = std::get_if<AllOfRegion>(&region.shape))
    for (Region& part : all->parts) name_region(part, key);
  if (auto* any = std::get_if<AnyOfRegion>(&region.shape))
    for (Region& part : any->parts) name_region(part, key);
}

void name_body(Body& b) {
  const std::string key = "bodies." + b.name;
  name_place(b.place, key);
  name_place(b.domain_place, key + ".domain");
  for (const auto& [place, name] : {std::pair{&b.thickness_place, "thickness"},
                                    {&b.radius_place, "radius"},
                                    {&b.frames_place, "frames"},
                                    {&b.points_place, "points"},
                                    {&b.weights_place, "weights"},
                                    {&b.inertia_place, "inertia"},
                                    {&b.cells_place, "cells"},
                                    {&b.formulation_place, "formulation"},
                                    {&b.order_place, "order"},
                                    {&b.incompressibility_place, "incompressibility"},
                                    {&b.locking_place, "locking"}})
    name_place(*place, key + "." + name);
  for (MaterialUse& use : b.materials) {
    name_region(use.where, key + ".material");
    name_place(use.material.place, key + ".material");
    if (use.material.activation) name_place(use.material.activation->place, key + ".material.active");
    for (Fibres& family : use.material.fibres) name_place(family.place, key + ".material.fibres");
  }
  for (ThicknessUse& use : b.thickness) name_region(use.where, key + ".thickness");
  if (auto* file = std::get_if<FileDomain>(&b.domain)) {
    name_place(file->place, key + ".domain.file");
    name_place(file->refine_place, key + ".domain.refine");
  }
  if (auto* between = std::get_if<BetweenDomain>(&b.domain)) {
    name_region(between->where, key + ".domain.where");
    for (Place& place : between->places) name_place(place, key + ".domain.between");
  }
  if (b.fluid) name_place(b.fluid->place, key + ".fluid");
  if (b.shares)
    for (SharedNodes& share : *b.shares) {
      name_place(share.place, key + ".share");
      name_place(share.body_place, key + ".share.body");
      name_region(share.where, key + ".share.where");
    }
}

}  // namespace

void name_places(Scene& scene) {
  for (Body& b : scene.bodies) name_body(b);
  for (std::size_t i = 0; i < scene.constraints.size(); ++i) {
    name_place(scene.constraints[i].place, fmt::format("constraints[{}]", i));
    name_region(scene.constraints[i].where, fmt::format("constraints[{}].where", i));
  }
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    name_place(scene.loads[i].place, fmt::format("loads[{}]", i));
    name_place(scene.loads[i].at_place, fmt::format("loads[{}].at", i));
    if (scene.loads[i].where) name_region(*scene.loads[i].where, fmt::format("loads[{}].where", i));
  }
  for (Coupling& c : scene.couplings) {
    name_place(c.place, "couplings." + c.name);
    name_place(c.to_place, "couplings." + c.name + ".to");
    name_region(c.where, "couplings." + c.name + ".where");
  }
  for (Probe& p : scene.probes) {
    name_place(p.place, "probes." + p.name);
    name_place(p.at_place, "probes." + p.name + ".at");
    if (p.where) name_region(*p.where, "probes." + p.name + ".where");
  }
  name_place(scene.solver.place, "solver");
  name_place(scene.solver.time_step_place, "solver.time_step");
  if (scene.solver.controlled) name_place(scene.solver.controlled->at_place, "solver.controlled.at");
  name_place(scene.solver.imperfection_place, "solver.imperfection");
}

}  // namespace fascia
