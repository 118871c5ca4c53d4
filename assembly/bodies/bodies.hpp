#pragma once

#include "assembly/simulation/simulation.hpp"
#include "core/body/model_body.hpp"
#include "meshless/cloud_build.hpp"
#include "meshless/shared_frame.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fascia {

/// What a body is built into, and what other bodies give to it.
struct BodyBuild {
  Model& model;
  PointSetBuilder& points;
  std::vector<SharedFrame> shared;
  std::optional<MatterParts> between;  ///< of a domain between two bodies
  std::vector<Interface> interfaces;
  std::string gap;  ///< what it fills between two bodies, in words
  std::vector<std::string> messages;
  int threads = 1;                     ///< that sample matter; 0: as many as there are processors
  const SampleStore* store = nullptr;  ///< of samples; null: none
};

/// Adds a body's frames to the model and its points to the builder. The body refers to the scene's.
/// @throws SceneError, InputError, FileError
std::unique_ptr<ModelBody> build_body(const Body& body, BodyBuild& build);

/// The same for finite elements.
std::unique_ptr<ModelBody> build_element_body(const Body& body, Model& model, PointSetBuilder& points);

/// What a material is anywhere, but for what its muscle makes.
PointMaterialSpec point_material(const Material& material);

/// What its muscle makes at a rest position, or null. @throws SceneError  as fibre_direction()
std::shared_ptr<const ActiveStress> active_stress(const Material& material, const Vec3d& X);

/// How much a body will be, roughly, before anything is allocated.
struct SampleEstimate {
  double frames = 0, points = 0, pieces = 0;
  double neighbours = 8;  ///< frames of a group of points
  double coupled = 27;    ///< frames that a frame shares points with
};
SampleEstimate estimated_samples(const Body& body);
SampleEstimate estimated_elements(const Body& body);

}  // namespace fascia
