// Documents, names and temporary files for STEP.
#include "common/cad/step_document.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDataStd_Name.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <filesystem>
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

TemporaryFile::TemporaryFile(const std::string& extension)
    : path_((std::filesystem::temp_directory_path() / ("mortise-" + NewIdentifier() + extension))
                .string()) {}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace mortise::cad
