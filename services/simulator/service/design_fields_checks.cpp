#include "services/simulator/service/design_fields_checks.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/expressions/identifier.h"
#include "common/fields/fields_file.h"
#include "common/store/blob_folder.h"
#include "common/store/blob_upkeep.h"
#include "services/simulator/worker/fields_codec.h"

namespace mortise::simulator {
namespace {

using FieldMessage = v1::DesignSpace::FieldDescription;

constexpr int kMaxFields = 100;
constexpr int kMaxRegions = 1000;
constexpr int kMaxModes = 100;
constexpr double kMinStep = 1e-9;  // m
constexpr double kMaxStep = 0.01;  // m
constexpr std::size_t kMaxUnitLength = 50;
constexpr std::size_t kMaxDescriptionLength = 1000;

const FieldMessage* FindField(const v1::DesignSpace& space, const std::string& name) {
  for (const FieldMessage& field : space.fields()) {
    if (field.name() == name) return &field;
  }
  return nullptr;
}

absl::Status CheckGeometry(const v1::DesignSpace& space, v1::GeometryKind wanted) {
  if (wanted != v1::SURFACE && wanted != v1::TETRAHEDRA) {
    return InvalidField("design_fields.geometry", "must be SURFACE or TETRAHEDRA");
  }
  if (wanted <= space.geometry()) return absl::OkStatus();
  return InvalidField(
      "design_fields.geometry",
      space.geometry() == v1::SURFACE
          ? absl::StrCat(space.subject(), " offers no tetrahedra; there is the SURFACE")
          : absl::StrCat(space.subject(), " offers no geometry and fields"));
}

absl::Status CheckFieldNames(const v1::DesignSpace& space, const v1::DesignFieldsRequest& wanted) {
  std::set<std::string> names;
  for (int i = 0; i < wanted.fields_size(); ++i) {
    const std::string place = absl::StrCat("design_fields.fields[", i, "]");
    const FieldMessage* const offered = FindField(space, wanted.fields(i));
    if (offered == nullptr) {
      const std::string all = absl::StrJoin(
          space.fields(), ", ",
          [](std::string* out, const FieldMessage& field) { out->append(field.name()); });
      return InvalidField(place, absl::StrCat("'", wanted.fields(i), "' is not offered; there are ",
                                              all.empty() ? "none" : all));
    }
    if (!names.insert(wanted.fields(i)).second) {
      return InvalidField(place, absl::StrCat("'", wanted.fields(i), "' is there twice"));
    }
    if (!offered->of_elements() || wanted.geometry() == v1::TETRAHEDRA) continue;
    return InvalidField(place, absl::StrCat("'", wanted.fields(i),
                                            "' is of tetrahedra: geometry must be TETRAHEDRA"));
  }
  return absl::OkStatus();
}

absl::Status CheckRegionNames(const v1::DesignFieldsRequest& wanted) {
  if (wanted.regions_size() > kMaxRegions) {
    return InvalidField("design_fields.regions", absl::StrCat("must be up to ", kMaxRegions));
  }
  std::set<std::string> names;
  for (int i = 0; i < wanted.regions_size(); ++i) {
    const std::string place = absl::StrCat("design_fields.regions[", i, "]");
    if (wanted.regions(i).empty()) return InvalidField(place, "must not be empty");
    if (wanted.regions(i).size() > fields::kMaximumNameLength) {
      return InvalidField(place,
                          absl::StrCat("is longer than ", fields::kMaximumNameLength, " bytes"));
    }
    if (names.insert(wanted.regions(i)).second) continue;
    return InvalidField(place, absl::StrCat("'", wanted.regions(i), "' is there twice"));
  }
  return absl::OkStatus();
}

absl::Status CheckOfferedField(const v1::DesignSpace& space, const FieldMessage& field,
                               const std::string& place, std::set<std::string>& names) {
  if (!parametric::IsIdentifier(field.name())) {
    return InvalidField(place + ".name",
                        "must be a letter or underscore, then letters, digits, underscores");
  }
  if (!names.insert(field.name()).second) {
    return InvalidField(place + ".name", absl::StrCat("'", field.name(), "' is there twice"));
  }
  if (field.unit().size() > kMaxUnitLength) {
    return InvalidField(place + ".unit", absl::StrCat("is longer than ", kMaxUnitLength, " bytes"));
  }
  if (field.description().size() > kMaxDescriptionLength) {
    return InvalidField(place + ".description",
                        absl::StrCat("is longer than ", kMaxDescriptionLength, " bytes"));
  }
  if (field.components() < 1 || field.components() > fields::kMaximumComponents) {
    return InvalidField(place + ".components",
                        absl::StrCat("must be 1 to ", fields::kMaximumComponents));
  }
  if (!field.of_elements() || space.geometry() == v1::TETRAHEDRA) return absl::OkStatus();
  return InvalidField(place + ".of_elements", "needs the geometry TETRAHEDRA");
}

// Whether every field of a file is as the space describes it.
absl::Status CheckFileFields(const v1::DesignSpace& space, const ReportedFile& file) {
  for (const FieldMessage& field : file.fields) {
    const FieldMessage* const offered = FindField(space, field.name());
    const std::string what = absl::StrCat("'", field.name(), "' of the file ");
    if (offered == nullptr) continue;
    if (field.unit() != offered->unit()) {
      return InvalidField(
          "result.design_fields.fields",
          absl::StrCat(what, "is in '", field.unit(), "'; it must be in '", offered->unit(), "'"));
    }
    if (field.components() != offered->components()) {
      return InvalidField("result.design_fields.fields",
                          absl::StrCat(what, "has ", field.components(), " components; it must be ",
                                       offered->components()));
    }
    if (field.of_elements() == offered->of_elements()) continue;
    return InvalidField(
        "result.design_fields.fields",
        absl::StrCat(what, "must be of ", offered->of_elements() ? "elements" : "nodes"));
  }
  return absl::OkStatus();
}

absl::Status CheckFile(const v1::DesignFieldsRequest& wanted, const v1::DesignSpace& space,
                       const ReportedFile& file) {
  const v1::DesignFields& found = file.description;
  if (wanted.geometry() > found.geometry()) {
    return InvalidField("result.design_fields.geometry", "has no tetrahedra, which were asked for");
  }
  if (!std::equal(wanted.fields().begin(), wanted.fields().end(), found.fields().begin(),
                  found.fields().end())) {
    return InvalidField(
        "result.design_fields.fields",
        absl::StrCat("are '", absl::StrJoin(found.fields(), ", "), "'; asked for were '",
                     absl::StrJoin(wanted.fields(), ", "), "'"));
  }
  for (const std::string& region : wanted.regions()) {
    if (std::count(found.regions().begin(), found.regions().end(), region) > 0) continue;
    return InvalidField("result.design_fields.regions",
                        absl::StrCat("lack '", region, "', which was asked for"));
  }
  return CheckFileFields(space, file);
}

}  // namespace

absl::Status CheckWanted(const v1::DesignSpace& space, const v1::DesignFieldsRequest& wanted) {
  MORTISE_RETURN_IF_ERROR(CheckGeometry(space, wanted.geometry()));
  MORTISE_RETURN_IF_ERROR(CheckFieldNames(space, wanted));
  MORTISE_RETURN_IF_ERROR(CheckRegionNames(wanted));
  const double step = wanted.position_step();
  if (step != 0 && !(step >= kMinStep && step <= kMaxStep)) {
    return InvalidField("design_fields.position_step",
                        absl::StrCat("must be within ", kMinStep, " to ", kMaxStep,
                                     " m, or 0 for exact positions"));
  }
  if (wanted.modes() >= 0 && wanted.modes() <= kMaxModes) return absl::OkStatus();
  return InvalidField("design_fields.modes", absl::StrCat("must be within 0 to ", kMaxModes));
}

absl::Status CheckOffered(const v1::DesignSpace& space, const std::string& field) {
  if (!v1::GeometryKind_IsValid(space.geometry())) {
    return InvalidField(field + ".geometry", "must be SURFACE, TETRAHEDRA or unspecified");
  }
  if (space.fields_size() > 0 && space.geometry() == v1::GEOMETRY_KIND_UNSPECIFIED) {
    return InvalidField(field + ".fields", "need a geometry");
  }
  if (space.fields_size() > kMaxFields) {
    return InvalidField(field + ".fields", absl::StrCat("must be up to ", kMaxFields));
  }
  std::set<std::string> names;
  for (int i = 0; i < space.fields_size(); ++i) {
    MORTISE_RETURN_IF_ERROR(
        CheckOfferedField(space, space.fields(i), absl::StrCat(field, ".fields[", i, "]"), names));
  }
  return absl::OkStatus();
}

absl::StatusOr<ReportedFile> ReadReported(store::BlobFolder& blobs, const std::string& sha256) {
  constexpr char kPlace[] = "result.design_fields.sha256";
  // It is kept from when it is named, not from when it was uploaded.
  store::TouchBlob(blobs, sha256).IgnoreError();
  const absl::StatusOr<std::string> bytes =
      blobs.Get(sha256, static_cast<std::size_t>(fields::kMaximumFileSize));
  if (absl::IsNotFound(bytes.status())) return InvalidField(kPlace, "has not been uploaded");
  if (absl::IsResourceExhausted(bytes.status())) {
    return InvalidField(
        kPlace, absl::StrCat("is of a file of more than ", fields::kMaximumFileSize, " bytes"));
  }
  if (absl::IsInvalidArgument(bytes.status())) {
    return InvalidField(kPlace, "must be 64 lower-case hexadecimal digits");
  }
  MORTISE_RETURN_IF_ERROR(bytes.status());
  const absl::StatusOr<fields::DesignFields> design = fields::ReadFields(*bytes);
  if (!design.ok()) {
    return InvalidField(
        kPlace, absl::StrCat("is of a file that cannot be read: ", design.status().message()));
  }
  ReportedFile file{.description = Describe(*design, sha256, bytes->size()), .fields = {}};
  for (const fields::Field& field : design->fields) {
    FieldMessage& message = file.fields.emplace_back();
    message.set_name(field.name);
    message.set_unit(field.unit);
    message.set_components(static_cast<int>(field.values.rows()));
    message.set_of_elements(field.place == fields::FieldPlace::kElements);
  }
  return file;
}

absl::Status CompleteDesignFields(const v1::Task& task, const v1::DesignSpace& space,
                                  const absl::StatusOr<ReportedFile>& file,
                                  v1::EvaluationResult& result) {
  if (!task.has_design_fields()) {
    if (!result.has_design_fields()) return absl::OkStatus();
    return InvalidField("result.design_fields", "were not asked for");
  }
  if (!result.has_design_fields()) {
    return InvalidField("result.design_fields", "must name the file that was asked for");
  }
  MORTISE_RETURN_IF_ERROR(file.status());
  MORTISE_RETURN_IF_ERROR(CheckFile(task.design_fields(), space, *file));
  *result.mutable_design_fields() = file->description;
  return absl::OkStatus();
}

}  // namespace mortise::simulator
