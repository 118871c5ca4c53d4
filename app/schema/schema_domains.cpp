#include "app/schema/schema.hpp"

namespace fascia::app {
namespace {

/// Cells of a solid, of which rigid bodies and surfaces take the skin.
Key cells(std::size_t count, const std::string& meaning) {
  return key("cells", array(integer(between(1, 10000)), count, count),
             meaning +
                 " Needed by `model = \"tetrahedra\"` and `\"hexahedra\"`, unless the scene states a `need`; refused "
                 "by "
                 "`\"meshless\"`.")
      .defaults("1 each for `\"rigid\"` and `\"surface\"`");
}

Key surface_cells(const std::string& meaning) {
  return key(
      "cells", array(integer(between(1, 10000)), 2, 2),
      meaning +
          " Needed by `model = \"shell\"`, unless the scene states a `need`, `\"rigid\"` and `\"surface\"`; refused "
          "by others.");
}

/// Cells of a domain that is a solid or its skin.
Key solid_or_skin_cells(std::size_t least, const std::string& meaning) {
  return key(
      "cells", array(integer(between(1, 10000)), least, 2),
      meaning +
          " Needed by all models but `\"meshless\"`, which refuses them; of a field of its own not where the scene "
          "states a `need`.");
}

std::string skin_models() { return "`model = \"shell\"`, `\"rigid\"` and `\"surface\"`."; }

Key diagonal() {
  return key("diagonal",
             choice({{"right", "From the lower left corner to the upper right."},
                     {"left", "From the lower right corner to the upper left."},
                     {"alternating", "Both in turn, as on a chessboard."}}),
             "What cuts a cell into two triangles, seen with its first direction to the right, its second up and the "
             "normal to the viewer. Only for " +
                 skin_models())
      .defaults("\"right\"");
}

Key angle(const char* about) {
  return key("angle", array(number("rad"), 2, 2),
             std::string("Where a sector begins and ends, ascending, about ") + about +
                 "; 0 is along the coordinate axis that follows the one nearest to it: x about z, y about x, z about "
                 "y. Only for " +
                 skin_models())
      .defaults("a whole turn");
}

Key closed() {
  return key("closed", boolean(),
             "Whether the two edges of a whole turn are one; `false`: a slit. Only for " + skin_models())
      .defaults("true for a whole turn");
}

Key split() {
  return key("split", integer(between(5, 6)),
             "Tetrahedra of a cell: 6 around its main diagonal, or 5, mirrored from cell to cell. Only for `model = "
             "\"tetrahedra\"`.")
      .defaults("6");
}

Shape box() {
  return table({key("min", vector3("m"), "Lower corner.").needed(), key("max", vector3("m"), "Upper corner.").needed(),
                cells(3, "Cells along x, y and z."), split()});
}

Shape block() {
  return table({key("corners", array(vector3("m"), 8, 8),
                    "Four corners of the lower face, counter-clockwise seen from above, then the four above them (the "
                    "order of a VTK hexahedron). The block is their trilinear interpolation.")
                    .needed(),
                cells(3, "Cells from corner 0 to corners 1, 3 and 4."), split()});
}

Shape cylinder() {
  return table({key("from", vector3("m"), "Centre of one end.").needed(),
                key("to", vector3("m"), "Centre of the other end.").needed(),
                key("radius", number("m", above(0)), "Radius.").needed(),
                solid_or_skin_cells(2, "Cells along the axis and around it; around a solid a multiple of 4."),
                diagonal(), angle("the axis from `from` to `to`"), closed(),
                key("caps", boolean(), "Flat disks that close both ends of the skin. Only for " + skin_models())
                    .defaults("true for a closed skin")});
}

Key ellipsoid_cells() {
  return solid_or_skin_cells(1,
                             "Cells around, a multiple of 4, and, of a solid only, layers between core and surface.");
}

Shape ellipsoid() {
  return table({key("center", vector3("m"), "Centre.").needed(),
                key("radii", vector3("m", above(0)), "Half axes along x, y and z.").needed(), ellipsoid_cells()});
}

Shape sphere() {
  return table({key("center", vector3("m"), "Centre.").needed(),
                key("radius", number("m", above(0)), "Radius.").needed(), ellipsoid_cells()});
}

Shape annulus() {
  return table({key("center", vector3("m"), "Centre.").needed(),
                key("normal", vector3("1"), "Direction of the surface's normal.").needed(),
                key("inner", number("m", above(0)), "Inner radius.").needed(),
                key("outer", number("m", above(0)), "Outer radius, above the inner.").needed(),
                surface_cells("Cells outward and around."), diagonal(), angle("the normal"), closed()});
}

Shape rectangle() {
  return table(
      {key("origin", vector3("m"), "A corner.").needed(),
       key("edge_u", vector3("m"), "From `origin` to the next corner.").needed(),
       key("edge_v", vector3("m"), "From `origin` to the corner on the other side; not parallel to `edge_u`.").needed(),
       surface_cells("Cells along both edges."), diagonal()});
}

Shape line() {
  return table({key("from", vector3("m"), "One end.").needed(), key("to", vector3("m"), "The other end.").needed()});
}

}  // namespace

Shape domain_schema() {
  return table(
      {key("box", box(), "An axis-aligned box; for rigid bodies and surfaces its skin."),
       key("block", block(),
           "A tapered block between eight corners; for rigid bodies and surfaces its skin. Not for shells."),
       key("cylinder", cylinder(), "A solid cylinder; for shells, rigid bodies and surfaces its skin."),
       key("ellipsoid", ellipsoid(), "A solid ellipsoid; for shells, rigid bodies and surfaces its skin."),
       key("sphere", sphere(), "A solid ball; for shells, rigid bodies and surfaces its skin."),
       key("file", text("a path"),
           "A mesh: Gmsh 1, 2 to 2.2 or 4.1, VTK legacy, VTU, VTP, STL, OBJ, OFF or PLY. Closed surfaces and volume "
           "cells are solids; with `thickness`, triangles that bound no solid are sheets; with `radius`, its lines are "
           "lines. A shell, a "
           "rigid body or a surface takes the triangles, or the boundary of volume cells where there are none. The "
           "path is relative to the scene file."),
       key("unit", text("a unit of length"), "What a number of `file` means: \"mm\", \"cm\".").defaults("\"m\""),
       key("refine", integer(between(0, 6)),
           "How often every cell of `file` is cut: a tetrahedron or hexahedron into 8, a triangle into 4. Groups go "
           "with their cells, the shape stays. Only for `model = \"tetrahedra\"`, `\"hexahedra\"` and `\"shell\"`.")
           .defaults("0"),
       key("rectangle", rectangle(), "A flat sheet between two edges; a meshless body or a shell needs `thickness`."),
       key("annulus", annulus(),
           "A flat ring or a sector of it; a meshless body of scattered frames or a shell needs `thickness`."),
       key("line", line(), "A straight line; the body needs `radius`."),
       key("between", array(text("the name of a body"), 2, 2),
           "Two bodies: the space between their surfaces, for a meshless body of scattered frames. It is where the "
           "bodies are, so the body has no `transform`."),
       key("where", reference("region", region_schema), "The parts of both surfaces that `between` connects.")
           .defaults("\"all\""),
       key("as",
           choice({{"volume", "All of the space."},
                   {"sheet", "A membrane from the middle of one part to that of the other; needs `thickness`."},
                   {"strands", "Straight strands from one part to the nearest points of the other; need `radius`."}}),
           "What fills the space of `between`.")
           .defaults("\"volume\"")},
      {{{"box", "block", "cylinder", "ellipsoid", "sphere", "file", "rectangle", "annulus", "line", "between"}}});
}

}  // namespace fascia::app
