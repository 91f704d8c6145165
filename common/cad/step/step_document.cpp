// Documents, names and temporary files for STEP.
#include "common/cad/step/step_document.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDataStd_Name.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <filesystem>
#include <gp_Mat.hxx>
#include <gp_Trsf.hxx>
#include <system_error>

#include "common/base/identifiers.h"

namespace mortise::cad {

std::mutex& StepTranslatorMutex() {
  static std::mutex mutex;
  return mutex;
}

Handle(TDocStd_Document) NewStepDocument() {
  // What goes wrong is said by statuses; the kernel would also print it.
  Message::DefaultMessenger()->ChangePrinters().Clear();
  // Without an application the document needs no resource files.
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  XCAFDoc_DocumentTool::Set(document->Main(), Standard_False);
  return document;
}

std::string NameOf(const TDF_Label& label) {
  Handle(TDataStd_Name) attribute;
  if (!label.FindAttribute(TDataStd_Name::GetID(), attribute)) return "";
  return TCollection_AsciiString(attribute->Get()).ToCString();
}

void SetName(const TDF_Label& label, const std::string& name) {
  TDataStd_Name::Set(label, TCollection_ExtendedString(name.c_str(), Standard_True));
}

TopLoc_Location ToLocation(const Eigen::Isometry3d& placement) {
  if (placement.matrix() == Eigen::Matrix4d::Identity()) return TopLoc_Location();
  const auto& m = placement.matrix();
  gp_Trsf motion;
  motion.SetValues(m(0, 0), m(0, 1), m(0, 2), m(0, 3), m(1, 0), m(1, 1), m(1, 2), m(1, 3), m(2, 0),
                   m(2, 1), m(2, 2), m(2, 3));
  return TopLoc_Location(motion);
}

Eigen::Isometry3d FromLocation(const TopLoc_Location& location) {
  const gp_Trsf motion = location.Transformation();
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      placement.matrix()(row, column) = motion.Value(row + 1, column + 1);
    }
  }
  return placement;
}

TemporaryFile::TemporaryFile(const std::string& extension)
    : path_((std::filesystem::temp_directory_path() / ("mortise-" + NewIdentifier() + extension))
                .string()) {}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace mortise::cad
