#include "common/cad/step/step_readback.h"

#include <BRepCheck_Analyzer.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <cmath>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>

#include "common/base/errors.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_document.h"
#include "common/cad/stretch/closed_faces.h"
#include "common/cad/stretch/solid_stretch.h"

namespace mortise::cad {
namespace {

constexpr double kInMillimetres = 1e9;  // of a cubic metre, the kernel's own unit
constexpr double kSameVolume = 1e-7;    // relative, of what is cut open
constexpr double kReadVolume = 1e-6;    // relative, of what is read again

bool IsReadAs(const std::string& bytes, double volume) {
  const std::lock_guard<std::mutex> lock(StepTranslatorMutex());
  STEPControl_Reader reader;
  std::istringstream stream(bytes);
  if (reader.ReadStream("step", stream) != IFSelect_RetDone) return false;
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  if (shape.IsNull() || !BRepCheck_Analyzer(shape).IsValid()) return false;
  return std::abs(AccurateVolume(shape) / kInMillimetres - volume) <= kReadVolume * volume;
}

// What was stretched is cut as it was drawn: the kernel cuts balls and rings better than splines.
TopoDS_Shape Opened(const Solid& solid, int way) {
  try {
    const auto& drawn = solid.kernel().stretched_from;
    if (!drawn) return CutOpen(solid.kernel().shape, way);
    const TopoDS_Shape open = CutOpen(drawn->shape, way);
    return open.IsNull() ? open : StretchSolid(open, drawn->map, drawn->volume);
  } catch (const Standard_Failure&) {
    return {};
  }
}

}  // namespace

absl::StatusOr<std::optional<Solid>> ReadableSolid(const Solid& solid, const SolidWriter& write) {
  const double volume = std::abs(AccurateVolume(solid.kernel().shape));
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, write(solid));
  if (IsReadAs(bytes, volume)) return solid;
  for (int way = 0; way < kWaysToCutOpen; ++way) {
    const TopoDS_Shape shape = Opened(solid, way);
    if (shape.IsNull() || !BRepCheck_Analyzer(shape).IsValid() ||
        std::abs(AccurateVolume(shape) - volume) > kSameVolume * volume) {
      continue;
    }
    auto kernel = std::make_shared<Solid::Kernel>(solid.kernel());
    kernel->shape = shape;
    const Solid open(std::move(kernel));
    MORTISE_ASSIGN_OR_RETURN(const std::string open_bytes, write(open));
    if (IsReadAs(open_bytes, volume)) return open;
  }
  return std::optional<Solid>();
}

}  // namespace mortise::cad
