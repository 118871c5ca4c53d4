#include "app/schema/schema.hpp"

namespace fascia::app {
namespace {

Key spacing_key(const char* doc) { return key("poisson_disk", number("m", above(0)), doc); }

Key seed_key(const char* otherwise) {
  return key("seed", integer(between(0, 2147483647)),
             "Another seed gives other samples; with `poisson_disk` or `count`.")
      .defaults(otherwise);
}

Shape share_schema() {
  const Shape region = reference("region", region_schema);
  return array(
      table({key("body", text("the name of a body"), "The other body.").needed(),
             key("where", region, "Its nodes; of a rigid body the vertices of its surface.").defaults("\"all\""),
             key("rotations", boolean(),
                 "Whether shared vertices, which have no rotation of their own, get one that only this body drives.")
                 .defaults("true")}));
}

std::vector<Choice> weight_choices() {
  return {{"trilinear", "Of a grid: the 8 frames of a cell; bilinear on a rectangle, linear on a line."},
          {"linear", "Of a solid's grid: the cells cut into 6 tetrahedra, each with 4 frames and 4 points of its own."},
          {"mls", "Of scattered frames: moving least squares, which reproduce linear fields."},
          {"shepard", "Of scattered frames: inverse distances, divided by their sum."},
          {"wendland", "Of scattered frames: Wendland's C2 kernels, divided by their sum."},
          {"cubic-spline", "Of scattered frames: cubic splines, divided by their sum."}};
}

}  // namespace

Shape frames_schema() {
  return table(
      {key("grid", array(integer(between(2, 1000)), 1, 3),
           "Frames of a regular grid: along x, y and z of a solid's bounding box, along both edges of a rectangle, or "
           "along a line; ends included."),
       spacing_key("Mean spacing of scattered frames (corners, edges and faces first)."),
       key("count", integer(between(1, 1e7)), "About this many scattered frames."),
       key("positions", array(vector3("m"), 1), "Rest positions of the frames."),
       key("rotations", array(vector3("rad")), "Rotation vectors of the rest axes, as many as `positions`.")
           .defaults("no rotation"),
       key("file", text("a path"),
           "Frames from a CSV file with columns x, y, z and, for rotation vectors, rx, ry, rz. The path is relative to "
           "the scene file."),
       seed_key("1"),
       key("kind", choice({{"rigid", "6 degrees of freedom a frame."}, {"affine", "12 degrees of freedom a frame."}}),
           "Kind of frame.")
           .defaults("\"rigid\""),
       key("share", share_schema(),
           "Nodes of other bodies that are frames of this one too, which couples them; beside any of the keys above.")
           .defaults("none")},
      {{{"grid", "poisson_disk", "count", "positions", "file"}, true, true}});
}

Shape points_schema() {
  return table(
      {key("per_cell", array(integer(between(1, 10)), 1, 3),
           "Gauss points along each direction of every cell of the frame grid, as many numbers as `frames.grid`. Not "
           "with `weights.kind = \"linear\"`.")
           .defaults("2 along each direction; 3 along one that has a single cell"),
       spacing_key("Mean spacing of points among scattered frames."),
       key("count", integer(between(1, 1e8)), "About this many points among scattered frames."),
       key("file", text("a path"),
           "Points among scattered frames, from a CSV file with columns x, y, z and, if you like, volume. The path is "
           "relative to the scene file."),
       seed_key("2"),
       key("integration",
           choice({{"auto", "Chosen from Poisson's ratio."},
                   {"full", "Everything at every point."},
                   {"selective", "The volumetric part at fewer points, against locking."}}),
           "Integration of the volumetric part.")
           .defaults("\"auto\""),
       key("through", integer(between(1, 10)),
           "Points through the thickness of a sheet; a line's section has 4 points. With 1, both follow the 2014 "
           "paper's "
           "rule, without the right stiffness in bending.")
           .defaults("2")},
      {{{"per_cell", "poisson_disk", "count", "file"}, false}});
}

Shape weights_schema() {
  return table(
      {key("kind", choice(weight_choices()), "Weight functions; always a partition of unity.")
           .defaults("\"trilinear\" on a grid, \"mls\" for scattered frames"),
       key("neighbours", integer(between(1, 1000)), "Scattered frames that a point follows.")
           .defaults("8 with `shepard`; the others go by reach"),
       key("radius", number("m", above(0)), "Reach of a scattered frame, in the place of `neighbours`.")
           .defaults("1.8 local spacings with `mls`, otherwise 2"),
       key("blend",
           choice({{"auto", "`half` where the weights reproduce linear fields."},
                   {"half", "Half blend; only for weights that reproduce linear fields: trilinear, linear, mls."},
                   {"full", "Equation 3 of the 2014 paper."}}),
           "How much of a frame's rotation a point follows.")
           .defaults("\"auto\""),
       key("drilling", number("1", at_least(0)),
           "Stiffness, relative to mu, that ties a frame's rotation to the material's; 0: none.")
           .defaults("0.1; affine frames 0.003")},
      {{{"neighbours", "radius"}, false}});
}

}  // namespace fascia::app
