#include "common/cad/step/solid_mirror.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/Eigenvalues>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <vector>

#include "common/cad/occt_vectors.h"
#include "common/cad/step/shape_samples.h"

namespace mortise::cad {
namespace {

constexpr double kSamePlace = 1e-6;         // of the size
constexpr double kMinPlace = 1e-7;          // m
constexpr std::size_t kMaxCorners = 8;      // vertices, and edges, through which planes are tried
constexpr std::size_t kMaxFeatures = 2000;  // of larger solids none is looked for
constexpr std::size_t kMaxPoints = 4000;    // nor if edges and faces bend so often

// A vertex, edge or face: where its middle is, and how large it is.
struct Feature {
  TopoDS_Shape shape;
  Eigen::Vector3d middle;
  double size = 0;
  std::vector<gp_Pnt> points;  // within edges and faces, once it is sampled
};

struct Features {
  std::vector<Feature> vertices, edges, faces;
  Eigen::Vector3d centre;
  Eigen::Matrix3d inertia;  // about the centre
  double reach = 0;         // of the vertices and edges from the centre, m
};

using Measure = void (*)(const TopoDS_Shape&, GProp_GProps&);

std::vector<Feature> Measured(const TopoDS_Shape& solid, TopAbs_ShapeEnum kind, Measure measure) {
  TopTools_IndexedMapOfShape found;
  TopExp::MapShapes(solid, kind, found);
  std::vector<Feature> features;
  for (int i = 1; i <= found.Extent(); ++i) {
    // Edges at the poles of balls have no length, nor a place.
    if (kind == TopAbs_EDGE && BRep_Tool::Degenerated(TopoDS::Edge(found(i)))) continue;
    GProp_GProps properties;
    measure(found(i), properties);
    features.push_back({found(i), ToEigen(properties.CentreOfMass()), properties.Mass(), {}});
  }
  return features;
}

Features FeaturesOf(const TopoDS_Shape& solid) {
  Features features;
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(solid, TopAbs_VERTEX, vertices);
  for (int i = 1; i <= vertices.Extent(); ++i) {
    features.vertices.push_back(
        {vertices(i), ToEigen(BRep_Tool::Pnt(TopoDS::Vertex(vertices(i)))), 0, {}});
  }
  features.edges = Measured(solid, TopAbs_EDGE, [](const TopoDS_Shape& edge, GProp_GProps& of) {
    BRepGProp::LinearProperties(edge, of);
  });
  features.faces = Measured(solid, TopAbs_FACE, [](const TopoDS_Shape& face, GProp_GProps& of) {
    BRepGProp::SurfaceProperties(face, of);
  });
  GProp_GProps volume;
  BRepGProp::VolumeProperties(solid, volume);
  features.centre = ToEigen(volume.CentreOfMass());
  const gp_Mat inertia = volume.MatrixOfInertia();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      features.inertia(row, column) = inertia(row + 1, column + 1);
    }
  }
  for (const auto* all : {&features.vertices, &features.edges}) {
    for (const Feature& feature : *all) {
      features.reach = std::max(features.reach, (feature.middle - features.centre).norm());
    }
  }
  return features;
}

bool AreAlike(const Feature& one, const Feature& other, const Eigen::Affine3d& mirror,
              double tolerance) {
  return (other.middle - mirror * one.middle).norm() <= tolerance &&
         std::abs(other.size - one.size) <= kSamePlace * std::max(other.size, one.size);
}

// Whether each mirrored feature may be another of them.
bool MayMapOntoThemselves(const std::vector<Feature>& features, const Eigen::Affine3d& mirror,
                          double tolerance) {
  return std::all_of(features.begin(), features.end(), [&](const Feature& feature) {
    return std::any_of(features.begin(), features.end(), [&](const Feature& other) {
      return AreAlike(feature, other, mirror, tolerance);
    });
  });
}

// Whether also what is within each mirrored edge or face is within another of them. The middles of
// twisted ones are where those of their mirror images are.
bool MapOntoThemselves(const std::vector<Feature>& features, const Eigen::Affine3d& mirror,
                       double tolerance) {
  return std::all_of(features.begin(), features.end(), [&](const Feature& feature) {
    std::vector<gp_Pnt> there;
    for (const gp_Pnt& point : feature.points) {
      const Eigen::Vector3d image = mirror * ToEigen(point);
      there.emplace_back(image.x(), image.y(), image.z());
    }
    return std::any_of(features.begin(), features.end(), [&](const Feature& other) {
      return AreAlike(feature, other, mirror, tolerance) &&
             (other.shape.ShapeType() == TopAbs_EDGE
                  ? LieOn(there, TopoDS::Edge(other.shape), tolerance)
                  : LieOn(there, TopoDS::Face(other.shape), tolerance));
    });
  });
}

// Finds points within all edges and faces. False, if these are too many, or none of some face.
bool TakeSamples(Features& features) {
  std::size_t left = kMaxPoints;
  for (auto* all : {&features.edges, &features.faces}) {
    for (Feature& feature : *all) {
      auto points = feature.shape.ShapeType() == TopAbs_EDGE
                        ? PointsWithin(TopoDS::Edge(feature.shape), left)
                        : PointsWithin(TopoDS::Face(feature.shape), left);
      if (!points || points->size() > left) return false;
      left -= points->size();
      feature.points = *std::move(points);
    }
  }
  return true;
}

Eigen::Affine3d MirrorAcross(const Eigen::Vector3d& normal, const Eigen::Vector3d& through) {
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose();
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  affine.linear() = mirror;
  affine.translation() = through - mirror * through;
  return affine;
}

std::vector<Eigen::Vector3d> LikelyNormals(const Features& features) {
  std::vector<Eigen::Vector3d> normals = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                          Eigen::Vector3d::UnitZ()};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(features.inertia);
  for (int i = 0; i < 3; ++i) normals.push_back(principal.eigenvectors().col(i));
  // Of round things, and of such as cubes, the axes of inertia are any, and where their edges begin
  // is not.
  std::vector<Eigen::Vector3d> others = normals;
  for (std::size_t e = 0; e < std::min(kMaxCorners, features.edges.size()); ++e) {
    others.push_back(features.edges[e].middle - features.centre);
  }
  for (std::size_t v = 0; v < std::min(kMaxCorners, features.vertices.size()); ++v) {
    for (const Eigen::Vector3d& other : others) {
      const Eigen::Vector3d normal = other.cross(features.vertices[v].middle - features.centre);
      if (normal.norm() > kSamePlace * other.norm() * features.reach) {
        normals.push_back(normal.normalized());
      }
    }
  }
  return normals;
}

// Those that map vertices, and middles of edges and faces, onto such, and agree with the inertia.
std::vector<Eigen::Affine3d> LikelyMirrors(const Features& features, double tolerance) {
  std::vector<Eigen::Affine3d> mirrors;
  for (const Eigen::Vector3d& normal : LikelyNormals(features)) {
    const Eigen::Affine3d mirror = MirrorAcross(normal, features.centre);
    const Eigen::Matrix3d inertia =
        mirror.linear() * features.inertia * mirror.linear().transpose();
    if ((inertia - features.inertia).norm() <= kSamePlace * features.inertia.norm() &&
        MayMapOntoThemselves(features.vertices, mirror, tolerance) &&
        MayMapOntoThemselves(features.edges, mirror, tolerance) &&
        MayMapOntoThemselves(features.faces, mirror, tolerance)) {
      mirrors.push_back(mirror);
    }
  }
  return mirrors;
}

}  // namespace

TopoDS_Shape DistortedSolid(const TopoDS_Shape& solid, double scale, bool mirrored) {
  gp_Trsf change;
  if (mirrored) change.SetMirror(gp_Ax2(gp_Pnt(), gp_Dir(0, 0, 1)));
  gp_Trsf larger;
  larger.SetScale(gp_Pnt(), scale);
  return BRepBuilderAPI_Transform(solid, larger * change, Standard_True).Shape();
}

std::optional<Eigen::Affine3d> OwnMirror(const TopoDS_Shape& solid) {
  Features features = FeaturesOf(solid);
  if (features.vertices.size() + features.edges.size() > kMaxFeatures) return std::nullopt;
  const double tolerance = std::max(kMinPlace, kSamePlace * features.reach);
  const std::vector<Eigen::Affine3d> likely = LikelyMirrors(features, tolerance);
  if (likely.empty() || !TakeSamples(features)) return std::nullopt;
  const auto found = std::find_if(likely.begin(), likely.end(), [&](const Eigen::Affine3d& mirror) {
    return MapOntoThemselves(features.edges, mirror, tolerance) &&
           MapOntoThemselves(features.faces, mirror, tolerance);
  });
  return found == likely.end() ? std::nullopt : std::optional(*found);
}

}  // namespace mortise::cad
