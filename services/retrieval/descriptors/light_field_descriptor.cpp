#include "services/retrieval/descriptors/light_field_descriptor.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/retrieval/descriptors/canonical_surface.h"
#include "services/retrieval/descriptors/fourier_coefficients.h"
#include "services/retrieval/descriptors/light_field_views.h"
#include "services/retrieval/descriptors/silhouette.h"
#include "services/retrieval/descriptors/zernike_moments.h"

namespace mortise::retrieval {
namespace {

// What the unit sphere is made of: a sphere around the triangles' corners, about the middle of the
// box around them.
struct Sphere {
  Eigen::Vector3d centre;
  double radius = 0;
};

Sphere SphereAround(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  Eigen::AlignedBox3d box;
  for (const int corner : triangles.reshaped()) box.extend(vertices.col(corner));
  Sphere sphere{box.center()};
  for (const int corner : triangles.reshaped()) {
    sphere.radius = std::max(sphere.radius, (vertices.col(corner) - sphere.centre).norm());
  }
  return sphere;
}

bool HasArea(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  for (const auto& corners : triangles.colwise()) {
    const Eigen::Vector3d a = vertices.col(corners[0]);
    const Eigen::Vector3d ab = vertices.col(corners[1]) - a, ac = vertices.col(corners[2]) - a;
    if (!ab.cross(ac).isZero(0)) return true;
  }
  return false;
}

}  // namespace

// What is measured of each view.
class LightFieldDescriptor::Features {
 public:
  explicit Features(const LightFieldSettings& settings)
      : settings_(settings),
        views_(LightFieldViews()),
        zernike_(settings.zernike_order),
        fourier_(settings.fourier_order) {}

  Eigen::Index views() const { return static_cast<Eigen::Index>(views_.size()); }
  Eigen::Index view_size() const { return zernike_.size() + fourier_.size(); }

  // Zeros where no view shows an area, as of a needle.
  Eigen::VectorXd Of(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) const {
    Eigen::VectorXd features = Eigen::VectorXd::Zero(views() * view_size());
    const Sphere sphere = SphereAround(vertices, triangles);
    if (!(sphere.radius > 0)) return features;
    const Eigen::Matrix3Xd placed = (vertices.colwise() - sphere.centre) / sphere.radius;
    // No row passes through the middle, as their number is even.
    SilhouetteRaster raster(settings_.rows, {-1, -1}, 2);
    for (Eigen::Index view = 0; view < views(); ++view) {
      const View& seen = views_[static_cast<std::size_t>(view)];
      features.segment(view * view_size(), view_size()) =
          seen.weight * OfView(seen, placed, triangles, raster);
    }
    return features;
  }

  // From what a view shows to what it shows if right and left are exchanged.
  Eigen::VectorXd MirrorSigns() const {
    Eigen::VectorXd signs(view_size());
    signs << zernike_.MirrorSigns(), fourier_.MirrorSigns();
    return signs;
  }

 private:
  Eigen::VectorXd OfView(const View& view, const Eigen::Matrix3Xd& vertices,
                         const Eigen::Matrix3Xi& triangles, SilhouetteRaster& raster) const {
    Eigen::Matrix<double, 2, 3> projection;
    projection << view.right.transpose(), view.up.transpose();
    const Eigen::Matrix2Xd points = projection * vertices;
    const Eigen::Rotation2Dd slant(view.slant);
    const Silhouette silhouette = raster.Draw(slant.toRotationMatrix() * points, triangles);
    Eigen::VectorXd features(view_size());
    features << zernike_.Of(silhouette, Eigen::Vector2d::Zero(), 1, view.slant),
        fourier_.Of(silhouette, view.slant);
    return features;
  }

  LightFieldSettings settings_;
  std::vector<View> views_;
  ZernikeMoments zernike_;
  FourierCoefficients fourier_;
};

class LightFieldDescriptor::Bound : public BoundDescriptor {
 public:
  Bound(CanonicalSurface surface, std::shared_ptr<const Features> features)
      : surface_(std::move(surface)), features_(std::move(features)) {}

  absl::StatusOr<Eigen::VectorXd> Describe(const Eigen::Matrix3Xd& vertices) const override {
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd placed, ToReferenceBox(surface_, vertices));
    if (!HasArea(placed, surface_.triangles)) {
      return InvalidField("vertices", "the surface has no area");
    }
    return features_->Of(placed, surface_.triangles);
  }

  absl::StatusOr<DescriptorDerivatives> Differentiate(
      const Eigen::Matrix3Xd& vertices,
      std::span<const Eigen::Matrix3Xd> velocities) const override {
    DescriptorDerivatives result;
    MORTISE_ASSIGN_OR_RETURN(result.value, Describe(vertices));
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd placed, ToReferenceBox(surface_, vertices));
    result.jacobian.setZero(result.value.size(), static_cast<Eigen::Index>(velocities.size()));
    for (Eigen::Index k = 0; k < result.jacobian.cols(); ++k) {
      MORTISE_ASSIGN_OR_RETURN(
          const Eigen::Matrix3Xd velocity,
          VelocitiesInReferenceBox(surface_, velocities[static_cast<std::size_t>(k)], k));
      double fastest = 0;
      for (const int corner : surface_.triangles.reshaped()) {
        fastest = std::max(fastest, velocity.col(corner).norm());
      }
      if (fastest == 0) continue;
      const double step = kDifferenceStep / fastest;
      result.jacobian.col(k) = (features_->Of(placed + step * velocity, surface_.triangles) -
                                features_->Of(placed - step * velocity, surface_.triangles)) /
                               (2 * step);
    }
    return result;
  }

 private:
  CanonicalSurface surface_;
  std::shared_ptr<const Features> features_;
};

LightFieldDescriptor::LightFieldDescriptor(const LightFieldSettings& settings)
    : features_(std::make_shared<const Features>(settings)) {
  properties_.name = "light-field";
  properties_.version = 1;
  properties_.dimension = features_->views() * features_->view_size();
  properties_.compares_turns = true;
  properties_.natural_scale = 0.55;
  properties_.sampling_noise = 0.005;
  properties_.bound_noise = 1e-4;
}

absl::StatusOr<std::unique_ptr<BoundDescriptor>> LightFieldDescriptor::Bind(
    const mesh::SurfaceMesh& surface) const {
  MORTISE_ASSIGN_OR_RETURN(CanonicalSurface canonical, MakeCanonical(surface));
  return std::make_unique<Bound>(std::move(canonical), features_);
}

Eigen::MatrixXd LightFieldDescriptor::QuarterTurns(const Eigen::VectorXd& vector) const {
  const std::vector<EarlierView> earlier = ViewsBeforeQuarterTurn();
  const Eigen::VectorXd signs = features_->MirrorSigns();
  const Eigen::Index size = features_->view_size();
  Eigen::MatrixXd turns(vector.size(), 4);
  turns.col(0) = vector;
  for (Eigen::Index turn = 1; turn < 4; ++turn) {
    for (std::size_t view = 0; view < earlier.size(); ++view) {
      auto now = turns.col(turn).segment(static_cast<Eigen::Index>(view) * size, size);
      now = turns.col(turn - 1).segment(earlier[view].view * size, size);
      if (earlier[view].mirrored) now.array() *= signs.array();
    }
  }
  return turns;
}

}  // namespace mortise::retrieval
