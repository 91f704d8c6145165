#include "tests/support/round_parts.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <Eigen/Geometry>
#include <TopExp_Explorer.hxx>
#include <gp_Ax2.hxx>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_assembly.h"
#include "common/cad/step/step_writer.h"

namespace mortise::testing {
namespace {

constexpr double kMillimetre = 1e-3;

cad::Solid SolidOf(const TopoDS_Shape& shape, const std::string& name) {
  auto kernel = std::make_shared<cad::Solid::Kernel>();
  kernel->name = name;
  kernel->shape = TopExp_Explorer(shape, TopAbs_SOLID).Current();
  return cad::Solid(std::move(kernel));
}

TopoDS_Shape Rod(double x, double y, double radius, double low, double high) {
  const gp_Ax2 axis(gp_Pnt(x, y, low), gp_Dir(0, 0, 1));
  return BRepPrimAPI_MakeCylinder(axis, radius, high - low).Solid();
}

TopoDS_Shape Ring(double inner, double outer, double low, double high) {
  return BRepAlgoAPI_Cut(Rod(0, 0, outer, low, high), Rod(0, 0, inner, low - 1, high + 1)).Shape();
}

// Collects parts, each of a product.
class Drawing {
 public:
  explicit Drawing(const std::string& name) {
    drawing_.name = name;
    drawing_.groups = {{name, -1}};
  }

  int AddProduct(const std::string& name, const TopoDS_Shape& shape) {
    drawing_.products.push_back({name, SolidOf(shape, name), {}});
    return static_cast<int>(drawing_.products.size()) - 1;
  }

  void AddPart(const std::string& name, int product, const Eigen::Vector3d& at) {
    cad::StepPart part;
    part.name = part.drawn_name = name;
    part.product = product;
    part.placement.translation() = at;
    drawing_.parts.push_back(std::move(part));
  }

  std::string Step() const { return cad::WriteStep(drawing_).value(); }

 private:
  cad::StepAssembly drawing_;
};

}  // namespace

std::string BearingStep() {
  Drawing drawing("bearing");
  const auto add = [&](const std::string& name, const TopoDS_Shape& shape) {
    drawing.AddPart(name, drawing.AddProduct(name, shape), Eigen::Vector3d::Zero());
  };
  const double mm = kMillimetre;
  add("shaft", Rod(0, 0, 10 * mm, 0, 100 * mm));
  add("inner ring", Ring(10 * mm, 16 * mm, 40 * mm, 60 * mm));
  add("outer ring", Ring(16 * mm, 24 * mm, 40 * mm, 60 * mm));
  add("housing", Ring(24 * mm, 40 * mm, 35 * mm, 65 * mm));
  add("collar left", Ring(10 * mm, 15 * mm, 30 * mm, 40 * mm));
  add("collar right", Ring(10 * mm, 15 * mm, 60 * mm, 70 * mm));
  add("cap", Rod(0, 0, 14 * mm, 100 * mm, 110 * mm));
  return drawing.Step();
}

std::string PinBoardStep(int pins) {
  constexpr int kInRow = 10;
  const double mm = kMillimetre, apart = 40 * mm, radius = 5 * mm, thick = 20 * mm;
  const int rows = (pins + kInRow - 1) / kInRow;
  const auto place = [&](int pin) {
    return Eigen::Vector3d((pin % kInRow + 0.5) * apart, (pin / kInRow + 0.5) * apart, 0);
  };
  TopoDS_Shape board = BRepPrimAPI_MakeBox(kInRow * apart, rows * apart, thick).Solid();
  for (int pin = 0; pin < pins; ++pin) {
    board = BRepAlgoAPI_Cut(board, Rod(place(pin).x(), place(pin).y(), radius, -mm, thick + mm));
  }
  Drawing drawing("pin board");
  drawing.AddPart("board", drawing.AddProduct("board", board), Eigen::Vector3d::Zero());
  const int pin_product = drawing.AddProduct("pin", Rod(0, 0, radius, -10 * mm, thick + 10 * mm));
  const int washer = drawing.AddProduct("washer", Ring(radius, 9 * mm, 0, 2 * mm));
  for (int pin = 0; pin < pins; ++pin) {
    drawing.AddPart(absl::StrCat("pin ", pin + 1), pin_product, place(pin));
    drawing.AddPart(absl::StrCat("upper washer ", pin + 1), washer,
                    place(pin) + thick * Eigen::Vector3d::UnitZ());
    drawing.AddPart(absl::StrCat("lower washer ", pin + 1), washer,
                    place(pin) - 2 * mm * Eigen::Vector3d::UnitZ());
  }
  return drawing.Step();
}

}  // namespace mortise::testing
