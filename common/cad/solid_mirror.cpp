#include "common/cad/solid_mirror.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <vector>

namespace mortise::cad {
namespace {

constexpr double kSamePlace = 1e-6;          // of the size
constexpr double kLeastPlace = 1e-7;         // m
constexpr int kMostVertices = 8;             // through which planes are tried
constexpr std::size_t kMostFeatures = 2000;  // of larger solids none is looked for

Eigen::Vector3d ToEigen(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

// A vertex, edge or face: where its middle is, and how large it is.
struct Feature {
  Eigen::Vector3d middle;
  double size = 0;
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
    features.push_back({ToEigen(properties.CentreOfMass()), properties.Mass()});
  }
  return features;
}

Features FeaturesOf(const TopoDS_Shape& solid) {
  Features features;
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(solid, TopAbs_VERTEX, vertices);
  for (int i = 1; i <= vertices.Extent(); ++i) {
    features.vertices.push_back({ToEigen(BRep_Tool::Pnt(TopoDS::Vertex(vertices(i)))), 0});
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

// Whether each mirrored feature is another of them.
bool MapsOntoThemselves(const std::vector<Feature>& features, const Eigen::Affine3d& mirror,
                        double tolerance) {
  return std::all_of(features.begin(), features.end(), [&](const Feature& feature) {
    const Eigen::Vector3d there = mirror * feature.middle;
    return std::any_of(features.begin(), features.end(), [&](const Feature& other) {
      return (other.middle - there).norm() <= tolerance &&
             std::abs(other.size - feature.size) <= kSamePlace * std::max(other.size, feature.size);
    });
  });
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
  // Of round things the axes across theirs are any, and where their edges begin is not.
  const std::size_t count = normals.size();
  for (std::size_t v = 0; v < std::min<std::size_t>(kMostVertices, features.vertices.size()); ++v) {
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d normal =
          normals[i].cross(features.vertices[v].middle - features.centre);
      if (normal.norm() > kSamePlace * features.reach) normals.push_back(normal.normalized());
    }
  }
  return normals;
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
  const Features features = FeaturesOf(solid);
  if (features.vertices.size() + features.edges.size() > kMostFeatures) return std::nullopt;
  const double tolerance = std::max(kLeastPlace, kSamePlace * features.reach);
  for (const Eigen::Vector3d& normal : LikelyNormals(features)) {
    const Eigen::Affine3d mirror = MirrorAcross(normal, features.centre);
    const Eigen::Matrix3d inertia =
        mirror.linear() * features.inertia * mirror.linear().transpose();
    if ((inertia - features.inertia).norm() <= kSamePlace * features.inertia.norm() &&
        MapsOntoThemselves(features.vertices, mirror, tolerance) &&
        MapsOntoThemselves(features.edges, mirror, tolerance) &&
        MapsOntoThemselves(features.faces, mirror, tolerance)) {
      return mirror;
    }
  }
  return std::nullopt;
}

}  // namespace mortise::cad
