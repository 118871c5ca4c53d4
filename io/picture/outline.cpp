#include "io/picture/outline.hpp"

#include <vtkCell.h>
#include <vtkCellArray.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGridGeometryFilter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace fascia::io {
namespace {

/// A face's edge: its ends in ascending order, the node between them or −1, and the face.
struct Edge {
  vtkIdType a = 0, b = 0, middle = -1, face = 0;
  bool joins_as(const Edge& o) const { return a == o.a && b == o.b; }
};

std::vector<Edge> sorted_edges(vtkDataSet& faces) {
  std::vector<Edge> edges;
  vtkNew<vtkGenericCell> cell;
  for (vtkIdType f = 0; f < faces.GetNumberOfCells(); ++f) {
    faces.GetCell(f, cell);
    for (int e = 0; e < cell->GetNumberOfEdges(); ++e) {
      vtkIdList* ids = cell->GetEdge(e)->GetPointIds();
      const auto [a, b] = std::minmax({ids->GetId(0), ids->GetId(1)});
      edges.push_back({a, b, ids->GetNumberOfIds() > 2 ? ids->GetId(2) : -1, f});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
    return std::tie(e.a, e.b, e.middle, e.face) < std::tie(f.a, f.b, f.middle, f.face);
  });
  return edges;
}

/// Lines between points of a data set.
class Lines {
 public:
  explicit Lines(vtkDataSet& source)
      : source_(source), number_(static_cast<std::size_t>(source.GetNumberOfPoints()), -1) {
    points_->SetDataTypeToDouble();
  }

  void add(const Edge& edge) {
    const std::array<vtkIdType, 3> through{edge.a, edge.middle, edge.b};
    lines_->InsertNextCell(edge.middle < 0 ? 2 : 3);
    for (const vtkIdType p : through)
      if (p >= 0) lines_->InsertCellPoint(point(p));
  }

  vtkSmartPointer<vtkPolyData> take() {
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_);
    data->SetLines(lines_);
    return data;
  }

 private:
  vtkIdType point(vtkIdType p) {
    vtkIdType& target = number_[static_cast<std::size_t>(p)];
    if (target < 0) target = points_->InsertNextPoint(source_.GetPoint(p));
    return target;
  }

  vtkDataSet& source_;
  std::vector<vtkIdType> number_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> lines_;
};

Vec3d point_of(vtkPolyData& faces, vtkIdType p) {
  Vec3d x;
  faces.GetPoint(p, x.v);
  return x;
}

/// Twice the area of each face along its normal [m²], and six times the volume that they enclose [m³].
struct Areas {
  std::vector<Vec3d> of_faces;
  double volume = 0;
};

Areas areas_of(vtkPolyData& faces) {
  Areas areas;
  vtkNew<vtkIdList> ids;
  Vec3d origin;
  if (faces.GetNumberOfPoints() > 0) origin = point_of(faces, 0);
  for (vtkIdType f = 0; f < faces.GetNumberOfCells(); ++f) {
    faces.GetCellPoints(f, ids);
    Vec3d area;
    const Vec3d first = point_of(faces, ids->GetId(0));
    for (vtkIdType n = 2; n < ids->GetNumberOfIds(); ++n)
      area += cross(point_of(faces, ids->GetId(n - 1)) - first, point_of(faces, ids->GetId(n)) - first);
    areas.volume += dot(first - origin, area);
    areas.of_faces.push_back(area);
  }
  return areas;
}

/// A group of the sorted edges that are one.
std::size_t end_of_group(const std::vector<Edge>& edges, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < edges.size() && edges[end].joins_as(edges[begin])) ++end;
  return end;
}

bool is_closed(const std::vector<Edge>& edges) {
  for (std::size_t i = 0; i < edges.size(); i = end_of_group(edges, i))
    if (end_of_group(edges, i) - i != 2) return false;
  return true;
}

}  // namespace

vtkSmartPointer<vtkPolyData> edges_of(vtkDataSet& faces) {
  const std::vector<Edge> edges = sorted_edges(faces);
  Lines lines(faces);
  for (std::size_t i = 0; i < edges.size(); i = end_of_group(edges, i)) lines.add(edges[i]);
  return lines.take();
}

vtkSmartPointer<vtkUnstructuredGrid> whole_faces(vtkUnstructuredGrid& grid, const std::vector<vtkIdType>& cells) {
  vtkNew<vtkUnstructuredGrid> volumes;
  volumes->SetPoints(grid.GetPoints());
  vtkNew<vtkIdList> ids;
  for (const vtkIdType c : cells) {
    grid.GetCellPoints(c, ids);
    volumes->InsertNextCell(grid.GetCellType(c), ids);
  }
  vtkNew<vtkUnstructuredGridGeometryFilter> filter;
  filter->SetInputData(volumes);
  filter->Update();
  return vtkUnstructuredGrid::SafeDownCast(filter->GetOutput());
}

vtkSmartPointer<vtkPolyData> outline_of(vtkPolyData& faces, const Vec3d& view) {
  const double sharp = std::cos(0.7);  // [rad] between normals
  const std::vector<Edge> edges = sorted_edges(faces);
  const Areas areas = areas_of(faces);
  const bool closed = is_closed(edges);
  const double outward = areas.volume < 0 ? -1 : 1;
  const auto faces_eye = [&](const Edge& e) {
    return outward * dot(areas.of_faces[static_cast<std::size_t>(e.face)], view) > 0;
  };
  const auto is_sharp = [&](const Edge& e, const Edge& f) {
    const Vec3d& m = areas.of_faces[static_cast<std::size_t>(e.face)];
    const Vec3d& n = areas.of_faces[static_cast<std::size_t>(f.face)];
    return dot(m, n) < sharp * norm(m) * norm(n);
  };
  Lines lines(faces);
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    end = end_of_group(edges, i);
    const Edge &e = edges[i], &f = edges[end - 1];
    const bool near = !closed || faces_eye(e) || faces_eye(f);
    if (end - i != 2 || faces_eye(e) != faces_eye(f) || (near && is_sharp(e, f))) lines.add(e);
  }
  return lines.take();
}

}  // namespace fascia::io
