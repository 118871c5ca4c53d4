#pragma once

#include "app/scene/scene.hpp"
#include "core/model/model_body.hpp"

#include <memory>
#include <string>
#include <vector>

namespace fascia::app {

/// Adds a body's frames to the model and its points to the builder. The body refers to the scene's.
/// @throws SceneError, InputError, FileError
std::unique_ptr<ModelBody> build_body(const Body& body, Model& model, PointSetBuilder& points,
                                      std::vector<std::string>& messages);

/// The same for finite elements.
std::unique_ptr<ModelBody> build_element_body(const Body& body, Model& model, PointSetBuilder& points);

/// What a material is at a point.
PointMaterialSpec point_material(const Material& material);

/// How much a body will be, roughly, before anything is allocated.
struct SampleEstimate {
  double frames = 0, points = 0, pieces = 0;
  double neighbours = 8;  ///< frames of a group of points
  double coupled = 27;    ///< frames that a frame shares points with
};
SampleEstimate estimated_samples(const Body& body);
SampleEstimate estimated_elements(const Body& body);

}  // namespace fascia::app
