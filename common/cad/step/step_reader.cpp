// Reads STEP through Open CASCADE's extended data framework.
#include "common/cad/step/step_reader.h"

#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <mutex>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/cad/step/step_collector.h"
#include "common/cad/step/step_document.h"
#include "common/cad/step/step_encoding.h"
#include "common/cad/step/step_losses.h"
#include "common/cad/step/step_naming.h"
#include "common/cad/step/step_operators.h"
#include "common/cad/step/step_places.h"
#include "common/cad/step/step_references.h"
#include "common/cad/step/step_statements.h"
#include "common/cad/step/step_structure.h"
#include "common/cad/step/step_units.h"

namespace mortise::cad {
namespace {

constexpr std::string_view kBegin = "ISO-10303-21;";
constexpr std::string_view kEnd = "END-ISO-10303-21;";
// The first string of FILE_SCHEMA(('…')).
std::string SchemaOf(std::string_view bytes) {
  const std::size_t header = bytes.find("FILE_SCHEMA");
  if (header == std::string_view::npos) return "";
  const std::size_t open = bytes.find('\'', header);
  if (open == std::string_view::npos) return "";
  const std::size_t close = bytes.find('\'', open + 1);
  if (close == std::string_view::npos) return "";
  return std::string(bytes.substr(open + 1, close - open - 1));
}

absl::Status CheckFrame(std::string_view bytes) {
  constexpr std::string_view kBlank = " \t\r\n\0";
  if (bytes.find_first_not_of(kBlank) == std::string_view::npos) {
    return InvalidField("step", "is empty");
  }
  // Some programs write a comment first.
  if (bytes.substr(0, 256).find(kBegin) == std::string_view::npos) {
    return InvalidField("step", "is not a STEP file: it does not begin with ISO-10303-21;");
  }
  const std::size_t tail = bytes.size() - std::min<std::size_t>(bytes.size(), 4096);
  if (bytes.substr(tail).find(kEnd) == std::string_view::npos) {
    return InvalidField("step", "is cut off: it does not end with END-ISO-10303-21;");
  }
  return absl::OkStatus();
}

// That the file has all that it refers to.
absl::Status CheckReferences(std::string_view bytes) {
  constexpr std::size_t kMaxShown = 5;
  const std::vector<MissingEntity> missing = MissingEntities(bytes, kMaxShown + 1);
  if (missing.empty()) return absl::OkStatus();
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < std::min(missing.size(), kMaxShown); ++i) {
    const std::string user = missing[i].user == 0 ? "" : absl::StrCat(" by #", missing[i].user);
    faults.push_back(
        absl::StrCat("#", missing[i].number, " is used", user, ", but is not in the file"));
  }
  if (missing.size() > kMaxShown) faults.push_back("and more are missing");
  return InvalidField("step", absl::StrJoin(faults, "; "));
}

// That its statements are such as the kernel can take.
absl::Status CheckStatements(std::string_view text) {
  constexpr std::size_t kMaxShown = 5;
  std::vector<std::string> faults = StatementFaults(text, kMaxShown + 1);
  if (faults.empty()) return absl::OkStatus();
  if (faults.size() > kMaxShown) faults.back() = "and there is more";
  return InvalidField("step", absl::StrJoin(faults, "; "));
}

// How the kernel reads while one does, for all the process: lengths in metres, and no names for
// what has none. The settings exist only once a reader does.
class ReaderSettings {
 public:
  ReaderSettings() : names_(XCAFDoc_ShapeTool::AutoNaming()) {
    Interface_Static::SetCVal("xstep.cascade.unit", "M");
    XCAFDoc_ShapeTool::SetAutoNaming(Standard_False);
  }
  ~ReaderSettings() {
    Interface_Static::SetCVal("xstep.cascade.unit", "MM");
    XCAFDoc_ShapeTool::SetAutoNaming(names_);
  }
  ReaderSettings(const ReaderSettings&) = delete;
  ReaderSettings& operator=(const ReaderSettings&) = delete;

 private:
  const Standard_Boolean names_;
};

void Append(std::vector<std::string> notes, std::vector<std::string>& all) {
  all.insert(all.end(), notes.begin(), notes.end());
}

// What is told when nothing is a solid.
absl::Status NoSolid(const StepAssembly& assembly, const std::vector<std::string>& losses) {
  std::vector<std::string> reasons = losses;
  for (const StepLeaf& leaf : assembly.leaves) {
    reasons.push_back(
        absl::StrCat("'", leaf.drawn_name, leaf.is_surface ? "' is a surface" : "' has no faces"));
  }
  constexpr std::size_t kMaxShown = 5;
  if (reasons.size() > kMaxShown) {
    reasons.resize(kMaxShown);
    reasons.push_back("and there is more");
  }
  return InvalidField("step", absl::StrCat("holds no solid", reasons.empty() ? "" : ": ",
                                           absl::StrJoin(reasons, "; ")));
}

absl::StatusOr<StepAssembly> Read(std::string_view bytes, const StepFaultsSeen& seen,
                                  const StepProgress& progress) {
  if (bytes.size() > kMaxStepBytes) return TooLarge("step", "64 MiB");
  MORTISE_ASSIGN_OR_RETURN(const StepText decoded, DecodeStep(bytes));
  MORTISE_RETURN_IF_ERROR(CheckFrame(decoded.text));
  MORTISE_RETURN_IF_ERROR(CheckStatements(decoded.text));
  MORTISE_RETURN_IF_ERROR(CheckReferences(decoded.text));
  const std::lock_guard<std::mutex> lock(StepTranslatorMutex());
  Handle(TDocStd_Document) document = NewStepDocument();
  STEPCAFControl_Reader reader;
  const ReaderSettings settings;
  std::istringstream stream{decoded.text};
  if (reader.ChangeReader().ReadStream("step", stream) != IFSelect_RetDone) {
    return InvalidField("step", "is not a STEP file that can be read");
  }
  const std::vector<std::string> faults = EntityFaults(reader);
  if (seen && !faults.empty()) seen(faults);
  MORTISE_RETURN_IF_ERROR(CheckStructure(reader));
  const auto model = Handle(StepData_StepModel)::DownCast(reader.ChangeReader().WS()->Model());
  KeepNames(model);
  StepAssembly assembly;
  assembly.notes = decoded.notes;
  Append(CompleteUnits(model), assembly.notes);
  MORTISE_ASSIGN_OR_RETURN(StepOperators operators, StepOperators::TakeFrom(reader));
  if (!reader.Transfer(document)) return InvalidField("step", "holds no shapes that can be read");
  operators.FindLocations(reader);
  assembly.schema = SchemaOf(decoded.text);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (!lengths.IsEmpty()) assembly.length_unit = lengths.First().ToCString();
  MORTISE_ASSIGN_OR_RETURN(
      const TopTools_MapOfShape leaves,
      CollectParts(document, operators, StepPlaces(reader), progress, assembly));
  const std::vector<std::string> losses = Losses(reader, leaves);
  if (assembly.parts.empty()) return NoSolid(assembly, losses);
  NameAll(assembly);
  TellOfDistortions(assembly);
  Append(losses, assembly.notes);
  for (const std::string& fault : faults) {
    assembly.notes.push_back(absl::StrCat("a fault that was passed over: ", fault));
  }
  return assembly;
}

}  // namespace

absl::StatusOr<StepAssembly> ReadStep(std::string_view bytes, const StepFaultsSeen& seen,
                                      const StepProgress& progress) {
  try {
    return Read(bytes, seen, progress);
  } catch (const Standard_Failure&) {
    return InvalidField("step", "is damaged: the CAD kernel cannot read it");
  }
}

}  // namespace mortise::cad
