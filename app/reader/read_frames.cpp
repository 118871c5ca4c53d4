#include "app/reader/readers.hpp"
#include "io/mesh/point_table.hpp"

#include <fmt/format.h>

#include <numeric>

namespace fascia::app {
namespace {

enum class Layout { grid, scattered };

/// How the frames lie; none where the scene does not say it, which is reported.
std::optional<Layout> layout_of(const TableReader& frames) {
  if (frames.has("grid")) return Layout::grid;
  for (const char* key : {"poisson_disk", "count", "positions", "file"})
    if (frames.has(key)) return Layout::scattered;
  return std::nullopt;
}

std::size_t dimension(Extent extent) { return extent == Extent::line ? 1 : extent == Extent::surface ? 2 : 3; }

const char* noun(Extent extent) {
  return extent == Extent::line ? "a line" : extent == Extent::surface ? "a rectangle" : "a solid";
}

/// One number for each direction of the body's grid; none where there are more or fewer.
std::optional<std::vector<int>> read_per_direction(const TableReader& table, std::string_view key,
                                                   std::optional<Extent> extent) {
  auto numbers = table.integers(key);
  if (!numbers || !extent || numbers->size() == dimension(*extent)) return numbers;
  const char* right = *extent == Extent::line      ? "1, along the line"
                      : *extent == Extent::surface ? "2, along edge_u and edge_v"
                                                   : "3, along x, y and z";
  table.error(key,
              fmt::format("a list of {} is of the wrong length; {} takes {}", numbers->size(), noun(*extent), right));
  return std::nullopt;
}

/// @param between  the domain is the space between two bodies
GridFrames read_grid(const TableReader& frames, std::optional<Extent> extent, bool between) {
  if (between) {
    frames.error("grid", "cannot fill the space between two bodies; use poisson_disk or count");
    return {};
  }
  if (extent == Extent::thin_mesh) {
    frames.error(
        "grid",
        "cannot fill an annulus, or sheets and lines of a mesh (thickness or radius is given); use poisson_disk or "
        "count");
    return {};
  }
  const auto grid = read_per_direction(frames, "grid", extent);
  if (!grid) return {};
  constexpr double most = 1e7;
  const double count = std::accumulate(grid->begin(), grid->end(), 1.0, std::multiplies<>());
  if (count > most) frames.error("grid", fmt::format("asks for {} frames; must be at most {}", count, most));
  return {*grid};
}

ListedFrames read_list(const TableReader& frames) {
  const auto positions = frames.vectors("positions"), rotations = frames.vectors("rotations");
  if (positions && rotations && positions->size() != rotations->size())
    frames.error("rotations", fmt::format("a list of {} does not fit positions, a list of {}; must be as long",
                                          rotations->size(), positions->size()));
  return {positions.value_or(std::vector<Vec3d>{}), rotations.value_or(std::vector<Vec3d>{})};
}

SampleFile read_samples(const TableReader& table, const std::filesystem::path& folder) {
  const std::string name = table.text("file").value_or("");
  if (table.value("file") && name.empty()) table.error("file", "is empty; must be the path of a CSV file");
  const std::filesystem::path path = folder / name;
  return {path, [path] { return io::read_point_table(path); }};
}

/// The keys `poisson_disk`, `count`, `file` and `seed`; `otherwise` without the first three.
template <class Samples>
Samples read_scattered(const TableReader& table, const std::filesystem::path& folder, int seed, Samples otherwise) {
  seed = table.integer("seed").value_or(seed);
  if (table.has("poisson_disk")) return SpacedSamples{table.number("poisson_disk").value_or(1), seed};
  if (table.has("count")) return CountedSamples{table.integer("count").value_or(1), seed};
  table.refuse({"seed"}, "is used only with poisson_disk or count");
  if (table.has("file")) return read_samples(table, folder);
  return otherwise;
}

Place place_of_first(const TableReader& table, std::initializer_list<const char*> keys, const Place& otherwise) {
  for (const char* key : keys)
    if (table.has(key)) return table.place(key);
  return table.exists() ? table.place() : otherwise;
}

std::vector<SharedNodes> read_shares(const TableReader& frames, const std::vector<std::string>& bodies,
                                     const std::string& own) {
  std::vector<SharedNodes> shares;
  for (const TableReader& share : frames.tables("share")) {
    const std::string body = share.text("body").value_or("");
    if (share.value("body")) check_other_body(body, share.place("body"), own, bodies, share.diagnostics());
    shares.push_back({share.place(), share.place("body"), body, read_region(share, "where"),
                      share.boolean("rotations").value_or(true)});
  }
  return shares;
}

/// @param bodies  names of all bodies
/// @param between  the domain is the space between two bodies
void read_frames(const TableReader& frames, const std::vector<std::string>& bodies, const std::filesystem::path& folder,
                 std::optional<Extent> extent, bool between, Body& body) {
  body.frames_place = place_of_first(frames, {"grid", "poisson_disk", "count", "positions", "file"}, body.place);
  body.affine = frames.text("kind") == "affine";
  if (!frames.has("positions")) frames.refuse({"rotations"}, "is used only with positions");
  Frames otherwise = GridFrames{};
  if (frames.has("grid"))
    otherwise = read_grid(frames, extent, between);
  else if (frames.has("positions"))
    otherwise = read_list(frames);
  body.frames = read_scattered<Frames>(frames, folder, 1, std::move(otherwise));
  if (frames.has("share")) body.shares = read_shares(frames, bodies, body.name);
}

void check_points(const TableReader& points, std::optional<Extent> extent, std::optional<Layout> layout) {
  if (layout == Layout::scattered && points.has("per_cell"))
    points.error("per_cell", "needs the cells of grid frames; use poisson_disk, count or file for scattered frames");
  if (layout != Layout::grid || extent != Extent::solid) return;
  for (const char* key : {"poisson_disk", "count", "file"})
    if (points.has(key))
      points.error(key, fmt::format("grid frames of {} take per_cell; use it, or scattered frames", noun(*extent)));
}

/// @param sheets  whether the domain can have any
void check_through(const TableReader& points, std::optional<Extent> extent, bool sheets) {
  const auto through = points.integer("through");
  if (!through || !extent || sheets) return;
  if (*extent == Extent::solid)
    points.refuse({"through"}, "is used only by sheets, not by a solid");
  else if (*through != 1)
    points.error("through", fmt::format("{} is not used by a line, whose section has 4 points; must be 1 (the 2014 "
                                        "paper's rule)",
                                        *through));
}

/// @param sheets  whether the domain can have any
void read_points(const TableReader& points, const std::filesystem::path& folder, std::optional<Extent> extent,
                 std::optional<Layout> layout, bool sheets, Body& body) {
  body.points_place = place_of_first(points, {"per_cell", "poisson_disk", "count", "file"}, body.place);
  check_points(points, extent, layout);
  Points otherwise;
  if (points.has("per_cell")) {
    const auto per_cell = read_per_direction(points, "per_cell", layout == Layout::grid ? extent : std::nullopt);
    otherwise = PerCell{per_cell.value_or(std::vector<int>{})};
    if (body.weights == WeightKind::linear)
      points.error("per_cell",
                   "is not used by weights of kind \"linear\", which have 4 points in each tetrahedron; remove it");
  }
  body.points = read_scattered<Points>(points, folder, 2, std::move(otherwise));
  body.through = points.integer("through");
  check_through(points, extent, sheets);
  const std::string integration = points.text("integration").value_or("auto");
  if (integration == "full") body.integration = Integration::full;
  if (integration == "selective") body.integration = Integration::selective;
  if (integration == "selective" && (layout == Layout::scattered || (extent && *extent != Extent::solid)))
    points.error("integration", "\"selective\" needs the grid of a solid; must be \"auto\" or \"full\"");
}

WeightKind weight_kind(const std::string& word) {
  if (word == "trilinear") return WeightKind::trilinear;
  if (word == "linear") return WeightKind::linear;
  if (word == "mls") return WeightKind::mls;
  if (word == "shepard") return WeightKind::shepard;
  if (word == "wendland") return WeightKind::wendland;
  if (word == "cubic-spline") return WeightKind::cubic_spline;
  return WeightKind::automatic;
}

bool reproduce_linear(WeightKind kind) {
  return kind != WeightKind::shepard && kind != WeightKind::wendland && kind != WeightKind::cubic_spline;
}

void check_kind(const TableReader& weights, const std::string& kind, std::optional<Extent> extent,
                std::optional<Layout> layout) {
  const bool of_grid = kind == "trilinear" || kind == "linear";
  const bool thin = extent && *extent != Extent::solid;
  if (layout == Layout::scattered && of_grid)
    weights.error("kind", fmt::format("\"{}\" needs grid frames; must be \"mls\", \"shepard\", \"wendland\" or "
                                      "\"cubic-spline\" for scattered frames",
                                      kind));
  if (layout == Layout::grid && !of_grid)
    weights.error("kind", fmt::format("\"{}\" needs scattered frames; must be \"trilinear\"{} on a grid", kind,
                                      thin ? "" : " or \"linear\""));
  if (layout == Layout::grid && kind == "linear" && thin)
    weights.error("kind",
                  fmt::format("\"linear\" needs the grid of a solid; must be \"trilinear\" for {}", noun(*extent)));
}

void read_weights(const TableReader& weights, std::optional<Extent> extent, std::optional<Layout> layout, Body& body) {
  body.weights_place = place_of_first(weights, {"kind"}, body.place);
  if (const auto kind = weights.text("kind")) {
    body.weights = weight_kind(*kind);
    check_kind(weights, *kind, extent, layout);
  }
  if (layout == Layout::grid)
    weights.refuse({"neighbours", "radius"}, "is used only by the weights of scattered frames");
  body.neighbours = weights.integer("neighbours");
  body.support = weights.number("radius");
  const std::string blend = weights.text("blend").value_or("auto");
  if (blend == "half") body.blend = Blend::half;
  if (blend == "full") body.blend = Blend::full;
  if (body.blend == Blend::half && !reproduce_linear(body.weights))
    weights.error("blend",
                  fmt::format("\"half\" is not sound for weights of kind \"{}\", which do not reproduce linear "
                              "fields; must be \"full\"",
                              *weights.text("kind")));
  body.drilling = weights.number("drilling");
}

/// Frames that a need chooses are those of a grid.
void check_open(const TableReader& table, const TableReader& frames, std::optional<Extent> extent, bool between) {
  const char* only = "; a need chooses grids alone, so say poisson_disk or count";
  if (between)
    table.error("frames", std::string("is missing, and a grid cannot fill the space between two bodies") + only);
  if (extent == Extent::thin_mesh)
    table.error("frames", std::string("is missing, and a grid cannot fill sheets and lines of a mesh") + only);
  if (frames.has("share"))
    frames.error("share",
                 "needs frames that lie on the nodes of the other body, which a need does not look for; say "
                 "poisson_disk or count");
}

}  // namespace

void read_discretisation(const TableReader& table, const std::vector<std::string>& bodies,
                         const std::filesystem::path& folder, Body& body) {
  const TableReader frames = table.table("frames");
  const bool between = table.table("domain").value("between") != nullptr;
  const std::optional<Extent> extent = read_extent(table);
  std::optional<Layout> layout = layout_of(frames);
  body.open = body.under_need && !layout && (frames.usable() || !table.has("frames"));
  if (body.open) layout = Layout::grid;
  if (body.open) check_open(table, frames, extent, between);
  read_frames(frames, bodies, folder, extent, between, body);
  const bool takes_grid = extent != Extent::thin_mesh && !between;
  if (!takes_grid && layout == Layout::grid) layout.reset();  // reported; what goes with it is open
  read_weights(table.table("weights"), extent, layout, body);
  const bool sheets = extent == Extent::surface || (extent == Extent::thin_mesh && table.has("thickness"));
  read_points(table.table("points"), folder, extent, layout, sheets, body);
}

}  // namespace fascia::app
