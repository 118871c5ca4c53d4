#include "io/picture/marks.hpp"

#include <vtkNew.h>
#include <vtkStaticPointLocator.h>

#include <cmath>
#include <map>
#include <set>

namespace fascia::io {
namespace {

/// Finds where material points of a body are.
class Places {
 public:
  explicit Places(const PictureBody& body) : body_(body) {
    vtkNew<vtkPolyData> rest;
    rest->SetPoints(body.rest);
    locator_->SetDataSet(rest);
    locator_->BuildLocator();
  }

  Vec3d of(const Vec3d& X) {
    const vtkIdType nearest = locator_->FindClosestPoint(X.v);
    Vec3d rest, now;
    body_.rest->GetPoint(nearest, rest.v);
    body_.now->GetPoint(nearest, now.v);
    return now + (X - rest);
  }

 private:
  const PictureBody& body_;
  vtkNew<vtkStaticPointLocator> locator_;
};

}  // namespace

Marks find_marks(const PictureDescription& description, const std::vector<PictureBody>& bodies) {
  std::map<std::string, Places> places;
  for (const PictureBody& body : bodies)
    if (body.rest && body.rest->GetNumberOfPoints() > 0) places.try_emplace(body.name, body);
  Marks marks;
  for (const PictureSupport& support : description.supports)
    if (const auto body = places.find(support.body); body != places.end())
      (support.whole ? marks.held : marks.held_in_part).push_back(body->second.of(support.X));
  for (const PictureSpring& spring : description.springs)
    if (const auto body = places.find(spring.body); body != places.end())
      marks.springs.push_back({body->second.of(spring.X), spring.point});
  return marks;
}

std::vector<Vec3d> thinned(const std::vector<Vec3d>& places, double size) {
  std::set<std::array<double, 3>> taken;
  std::vector<Vec3d> chosen;
  for (const Vec3d& x : places) {
    const std::array<double, 3> cube{std::floor(x[0] / size), std::floor(x[1] / size), std::floor(x[2] / size)};
    if (taken.insert(cube).second) chosen.push_back(x);
  }
  return chosen;
}

}  // namespace fascia::io
