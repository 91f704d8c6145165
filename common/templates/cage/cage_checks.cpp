#include "common/templates/cage/cage_checks.h"

#include <algorithm>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/names/offered_names.h"
#include "common/design/solid_head_checks.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxParameters = 64;
constexpr std::size_t kMaxDefinitions = 500;
constexpr std::size_t kMaxFaces = 500;
constexpr std::size_t kMaxConditions = 500;
constexpr std::size_t kMaxVertices = 5000;
constexpr std::size_t kMaxTriangles = 10'000;
constexpr std::size_t kMaxCageVertices = 250;
constexpr std::size_t kMaxCageTriangles = 500;
constexpr double kFarthest = 1e3;     // m, from the origin
constexpr double kMinVolume = 1e-12;  // m³
constexpr int kMaxFaults = 20;        // that are reported of one mesh

class CageChecker {
 public:
  explicit CageChecker(const CageTemplate& definition) : definition_(definition) {}

  std::vector<FieldViolation> Check() {
    CheckSolidTexts(definition_.name, definition_.title, definition_.description,
                    definition_.material, findings_);
    CheckSolidParameters(definition_.parameters, number_names_, findings_);
    CheckDefinitions();
    CheckSurface();
    CheckConditions();
    return std::move(findings_);
  }

 private:
  void Report(const std::string& field, const std::string& message) {
    findings_.push_back({field, message});
  }

  void CheckDefinitions() {
    for (std::size_t i = 0; i < definition_.definitions.size(); ++i) {
      CheckNumberName(absl::StrCat("definitions[", i, "].name"), definition_.definitions[i].name,
                      number_names_, findings_);
    }
  }

  // Whether all indices are of vertices that exist.
  bool CheckIndices(const std::string& field, const Eigen::Matrix3Xi& triangles,
                    Eigen::Index vertices) {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      if (triangles.col(t).minCoeff() >= 0 && triangles.col(t).maxCoeff() < vertices) continue;
      Report(field, absl::StrCat("triangle ", t, " names a vertex that does not exist"));
      return false;
    }
    return true;
  }

  void CheckSurface() {
    const CageSurface& surface = definition_.surface;
    bool usable = true;
    if (!surface.vertices.allFinite()) {
      Report("surface.vertices", "have a number that is not finite");
      usable = false;
    } else if (surface.vertices.cwiseAbs().maxCoeff() > kFarthest) {
      Report("surface.vertices", "reach farther than 1 km from the origin");
      usable = false;
    }
    for (std::size_t i = 0; i < surface.faces.size(); ++i) {
      const std::string field = absl::StrCat("surface.faces[", i, "]");
      CheckUniqueName(field + ".name", surface.faces[i].name, face_names_, findings_);
      if (surface.faces[i].triangles.cols() == 0) Report(field + ".triangles", "are missing");
      usable =
          CheckIndices(field + ".triangles", surface.faces[i].triangles, surface.vertices.cols()) &&
          usable;
    }
    if (usable) CheckShape({surface.vertices, TrianglesOf(surface)});
  }

  void CheckShape(const mesh::SurfaceMesh& surface) {
    const auto faults = mesh::CheckSurface(surface, kMaxFaults);
    for (const mesh::SurfaceFault& fault : faults) Report("surface", fault.message);
    std::vector<bool> used(static_cast<std::size_t>(surface.vertices.cols()), false);
    for (const int vertex : surface.triangles.reshaped()) {
      used[static_cast<std::size_t>(vertex)] = true;
    }
    const auto unused = std::find(used.begin(), used.end(), false);
    if (unused != used.end()) {
      Report("surface.vertices",
             absl::StrCat("vertex ", unused - used.begin(), " belongs to no triangle"));
    }
    if (!faults.empty()) return;
    if (mesh::ComputeMassProperties(surface).volume < kMinVolume) {
      Report("surface", "encloses less than 1e-12 m³");
    }
    const auto crossings = mesh::FindIntersections(surface.vertices, surface.triangles);
    if (!crossings.empty()) {
      Report("surface", absl::StrCat("triangles ", crossings[0].first, " and ", crossings[0].second,
                                     ", counted over all faces, cross"));
    }
  }

  void CheckConditions() {
    std::set<std::string> names;
    std::vector<ConditionUse> uses;
    for (std::size_t i = 0; i < definition_.conditions.size(); ++i) {
      const CageCondition& condition = definition_.conditions[i];
      const std::string field = absl::StrCat("conditions[", i, "]");
      CheckUniqueName(field + ".name", condition.name, names, findings_);
      CheckCondition(field, condition.kind, condition.components, condition.load_case, findings_);
      uses.push_back({condition.kind, condition.load_case});
      for (std::size_t k = 0; k < condition.faces.size(); ++k) {
        if (face_names_.contains(condition.faces[k])) continue;
        Report(absl::StrCat(field, ".faces[", k, "]"),
               absl::StrCat("there is no face '", condition.faces[k].substr(0, 80), "'",
                            NamesOffered(condition.faces[k].substr(0, 80),
                                         {face_names_.begin(), face_names_.end()})));
      }
    }
    CheckConditionsTogether("conditions", uses, definition_.reference_temperature, findings_);
  }

  const CageTemplate& definition_;
  std::vector<FieldViolation> findings_;
  std::set<std::string> number_names_, face_names_;
};

}  // namespace

std::vector<FieldViolation> CheckCageSizes(const CageTemplate& definition) {
  std::vector<FieldViolation> findings;
  const auto count = [&findings](const std::string& field, auto size, std::size_t least,
                                 std::size_t most) {
    CheckCount(field, static_cast<std::size_t>(size), least, most, findings);
  };
  count("parameters", definition.parameters.size(), 1, kMaxParameters);
  count("definitions", definition.definitions.size(), 0, kMaxDefinitions);
  count("surface.vertices", definition.surface.vertices.cols(), 4, kMaxVertices);
  count("surface.faces", definition.surface.faces.size(), 1, kMaxFaces);
  count("cage.vertices", definition.cage.vertices.size(), 4, kMaxCageVertices);
  count("cage.triangles", definition.cage.triangles.cols(), 4, kMaxCageTriangles);
  count("conditions", definition.conditions.size(), 0, kMaxConditions);
  if (!findings.empty()) return findings;
  count("surface.faces[*].triangles", TrianglesOf(definition.surface).cols(), 4, kMaxTriangles);
  for (std::size_t i = 0; i < definition.conditions.size(); ++i) {
    if (!ActsOnFace(definition.conditions[i].kind)) continue;
    count(absl::StrCat("conditions[", i, "].faces"), definition.conditions[i].faces.size(), 1,
          kMaxFaces);
  }
  return findings;
}

std::vector<FieldViolation> CheckCageTemplate(const CageTemplate& definition) {
  return CageChecker(definition).Check();
}

Eigen::Matrix3Xi TrianglesOf(const CageSurface& surface) {
  Eigen::Index count = 0;
  for (const CageFace& face : surface.faces) count += face.triangles.cols();
  Eigen::Matrix3Xi triangles(3, count);
  Eigen::Index first = 0;
  for (const CageFace& face : surface.faces) {
    triangles.middleCols(first, face.triangles.cols()) = face.triangles;
    first += face.triangles.cols();
  }
  return triangles;
}

}  // namespace mortise::parametric
