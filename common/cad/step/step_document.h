// Holds what writing and reading STEP have in common. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Geometry>
#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <mutex>
#include <string>

namespace mortise::cad {

// Returns the lock of the kernel's STEP translator, which keeps its settings in process-wide
// variables and so takes one user at a time.
std::mutex& StepTranslatorMutex();

// Makes an empty document for assemblies with names and colours.
Handle(TDocStd_Document) NewStepDocument();

// Returns the name of a label; empty if it has none.
std::string NameOf(const TDF_Label& label);
void SetName(const TDF_Label& label, const std::string& name);

// Convert between the kernel's rigid motions and ours, in the same unit of length.
TopLoc_Location ToLocation(const Eigen::Isometry3d& placement);
Eigen::Isometry3d FromLocation(const TopLoc_Location& location);

// A file in the folder for temporary files that disappears with this object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& extension);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace mortise::cad
