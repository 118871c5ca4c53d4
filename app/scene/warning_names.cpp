#include "app/scene/warning_names.hpp"

namespace fascia::app {

const std::vector<Choice>& warning_names() {
  static const std::vector<Choice> names = {
      {"mesh", "What was mended in a mesh, or looks wrong in it, such as elements that lock."},
      {"sampling", "Frames, points and weights of a meshless body."},
      {"far", "A body lies so far from the origin that digits are lost."},
      {"size", "A body is larger or smaller than what is made of such a material."},
      {"mass", "A body is heavier than what is made of such a material."},
      {"density", "A density that no such material has."},
      {"stiffness", "A Young's modulus that no such material has."},
      {"sag", "Gravity crushes a body under its own weight."},
      {"load", "A load is far above what a body can bear."},
      {"spring", "A spring is far stiffer or softer than what it holds."},
      {"velocity", "A body starts or is moved faster than it can bear."},
      {"damping", "Damping that stops all motion."},
      {"time-step", "A time step that does not resolve what happens."},
      {"duration", "A run that ends before anything happens, or takes too many steps."},
      {"overlap", "Bodies that intersect at rest and are not coupled."},
      {"apart", "A coupling joins what is far apart."},
      {"scattered", "A coupling holds scattered frames, and not the material at them."},
      {"held", "A body is held at all its nodes, or at none and falls."},
      {"no-effect", "A key does nothing in this scene."},
      {"initial", "An initial motion is lost on nodes that follow others."},
      {"rotations", "Positions are prescribed without rotations."},
      {"rigid", "A constraint holds the mass centre of a rigid body, and not the points of its region."},
      {"place", "The point of a probe or load was moved onto the body."},
      {"masses", "A probe counts masses that bodies share."},
      {"locking", "A single cell of frames that hardly bends."},
      {"backend", "The GPU was not used as the scene asks."},
      {"output", "The results will be large."},
      {"stability", "The end state is, or may be, unstable."},
      {"snap", "The elastic energy fell while all loads grew."},
      {"solver", "What the solver met on its way."},
      {"rounding", "Rounding is not small beside the loads."},
      {"inverted", "Matter is turned inside out."},
      {"resolution", "The deformation is finer than frames or cells."},
      {"hollow", "Modes of frames that the material hardly feels."}};
  return names;
}

}  // namespace fascia::app
