// Draws meshes from .vtu files of `mortise map shape` and `mortise analyze`, coloured by a field on
// one scale for all, side by side in one picture:
// field_pictures SHEET [--field NAME] [--unit TEXT] [--over NUMBER] [--range LOW:HIGH]
//   [--deform TIMES] [--mesh] [--alike] [--columns COUNT] [--width PIXELS] [--height PIXELS]
//   [--from X,Y,Z] CAPTION=FILE…
// Values are divided by --over, to come to the unit that is told. Without --range the scale is from
// 0, or the least value, to what 99.5 % of all nodes are below. --deform moves nodes by so many
// times their displacement; --mesh draws the sides of elements; --alike draws all as large as they
// are beside one another; without a field shapes are grey.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/render/image.h"
#include "common/render/scene.h"

namespace {

using namespace mortise;

constexpr std::int64_t kMostBytes = 500'000'000;

struct Request {
  std::string sheet;
  std::string field, unit;
  double over = 1;
  double deform = 0;
  std::vector<double> range;                 // low and high, or empty
  std::vector<double> from{1, -1.35, 0.85};  // where the eye is
  bool mesh = false, alike = false;
  int columns = 4, width = 520, height = 400;
  std::vector<std::string> pictures;  // "caption=file"
};

// A file as WriteVtu makes it.
class VtuFile {
 public:
  static absl::StatusOr<VtuFile> Read(const std::string& name) {
    VtuFile file;
    MORTISE_ASSIGN_OR_RETURN(file.bytes_, ReadFile(name, kMostBytes));
    file.data_ = file.bytes_.find("<AppendedData encoding=\"raw\">");
    if (file.data_ == std::string::npos) {
      return absl::InvalidArgumentError(absl::StrCat(name, " is no .vtu with raw data"));
    }
    file.data_ = file.bytes_.find('_', file.data_) + 1;
    return file;
  }

  // The array whose name is this, or begins with it and a blank.
  template <typename Number>
  absl::StatusOr<std::vector<Number>> Array(const std::string& name) const {
    for (std::size_t at = 0; (at = bytes_.find("<DataArray", at)) < data_; ++at) {
      const std::string tag = bytes_.substr(at, bytes_.find('>', at) - at);
      const std::string called = Attribute(tag, "Name");
      std::uint64_t offset = 0, size = 0;
      if ((called != name && !called.starts_with(name + " ")) ||
          !absl::SimpleAtoi(Attribute(tag, "offset"), &offset)) {
        continue;
      }
      if (data_ + offset + sizeof size > bytes_.size()) break;
      std::memcpy(&size, bytes_.data() + data_ + offset, sizeof size);
      if (data_ + offset + sizeof size + size > bytes_.size()) break;
      std::vector<Number> numbers(size / sizeof(Number));
      std::memcpy(numbers.data(), bytes_.data() + data_ + offset + sizeof size, size);
      return numbers;
    }
    return absl::InvalidArgumentError(absl::StrCat("there is no '", name, "' in the file"));
  }

 private:
  static std::string Attribute(const std::string& tag, const std::string& name) {
    const std::size_t begin = tag.find(" " + name + "=\"");
    if (begin == std::string::npos) return "";
    const std::size_t from = begin + name.size() + 3;
    return tag.substr(from, tag.find('"', from) - from);
  }

  std::string bytes_;
  std::size_t data_ = 0;
};

// The triangles themselves, or those of tetrahedra that no two have in common.
Eigen::Matrix3Xi Outside(const std::vector<std::int32_t>& cells, std::size_t corners) {
  std::map<std::array<int, 3>, std::array<int, 3>> faces;  // by their nodes in order
  const auto add = [&faces](std::array<int, 3> face) {
    std::array<int, 3> sorted = face;
    std::ranges::sort(sorted);
    if (!faces.emplace(sorted, face).second) faces.erase(sorted);
  };
  for (std::size_t c = 0; c < cells.size(); c += corners) {
    const std::int32_t* const n = &cells[c];
    if (corners == 3) {
      add({n[0], n[1], n[2]});
      continue;
    }
    for (const auto& [i, j, k] : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
      add({n[i], n[j], n[k]});
    }
  }
  Eigen::Matrix3Xi triangles(3, static_cast<Eigen::Index>(faces.size()));
  Eigen::Index last = 0;
  for (const auto& [sorted, face] : faces) {
    triangles.col(last++) = Eigen::Vector3i(face[0], face[1], face[2]);
  }
  return triangles;
}

absl::StatusOr<render::Shape> ReadShape(const std::string& name, const Request& request) {
  MORTISE_ASSIGN_OR_RETURN(const VtuFile file, VtuFile::Read(name));
  MORTISE_ASSIGN_OR_RETURN(const auto points, file.Array<double>("points"));
  MORTISE_ASSIGN_OR_RETURN(const auto cells, file.Array<std::int32_t>("connectivity"));
  MORTISE_ASSIGN_OR_RETURN(const auto offsets, file.Array<std::int64_t>("offsets"));
  if (points.empty() || offsets.empty()) return absl::InvalidArgumentError("there is no mesh");
  const auto nodes = static_cast<Eigen::Index>(points.size() / 3);
  render::Shape shape;
  shape.vertices = Eigen::Matrix3Xd::Map(points.data(), 3, nodes);
  shape.triangles = Outside(cells, static_cast<std::size_t>(offsets[0]));
  if (request.deform != 0) {
    MORTISE_ASSIGN_OR_RETURN(const auto moved, file.Array<double>("displacement"));
    shape.vertices += request.deform * Eigen::Matrix3Xd::Map(moved.data(), 3, nodes);
  }
  if (!request.field.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const auto values, file.Array<double>(request.field));
    const auto rows = static_cast<Eigen::Index>(values.size()) / nodes;
    const Eigen::MatrixXd field = Eigen::MatrixXd::Map(values.data(), rows, nodes) / request.over;
    shape.scalars =
        rows == 1 ? Eigen::VectorXd(field.row(0)) : Eigen::VectorXd(field.colwise().norm());
  }
  if (request.mesh) shape.feature_angle = -1;
  shape.edge_width = request.mesh ? 0.5 : 0.8;
  shape.smooth = !request.mesh;
  return shape;
}

render::ColorBar ScaleOf(const std::vector<render::Shape>& shapes, const Request& request) {
  const std::string title = absl::StrCat(request.field, " (", request.unit, ")");
  if (!request.range.empty()) return {request.range[0], request.range[1], title};
  std::vector<double> values;
  for (const render::Shape& shape : shapes) {
    for (const int node : shape.triangles.reshaped()) values.push_back(shape.scalars[node]);
  }
  std::ranges::sort(values);
  const double high =
      values[static_cast<std::size_t>(0.995 * static_cast<double>(values.size() - 1))];
  const double low = values.front();
  return {low > 0.5 * high ? low : std::min(low, 0.0), high, title};
}

absl::Status Draw(const Request& request) {
  std::vector<render::Shape> shapes;
  std::vector<std::string> captions;
  render::Scene together;
  for (const std::string& picture : request.pictures) {
    const std::size_t end = picture.rfind('=');
    if (end == std::string::npos) return absl::InvalidArgumentError("must be CAPTION=FILE");
    MORTISE_ASSIGN_OR_RETURN(render::Shape shape, ReadShape(picture.substr(end + 1), request));
    captions.push_back(picture.substr(0, end));
    together.shapes.push_back(shape);
    shapes.push_back(std::move(shape));
  }
  const Eigen::Vector3d from = Eigen::Vector3d::Map(request.from.data());
  const double aspect = static_cast<double>(request.width) / request.height;
  std::vector<render::Image> images;
  for (const render::Shape& shape : shapes) {
    render::Scene scene;
    scene.shapes.push_back(shape);
    scene.camera = render::FitCamera(render::BoundingBox(request.alike ? together : scene), from,
                                     aspect, true, 0.03);
    if (!request.field.empty()) scene.color_bar = ScaleOf(shapes, request);
    MORTISE_ASSIGN_OR_RETURN(
        images.emplace_back(),
        render::Render(scene, {.width = request.width, .height = request.height}));
  }
  MORTISE_ASSIGN_OR_RETURN(const render::Image sheet,
                           render::ContactSheet(images, captions, request.columns));
  MORTISE_ASSIGN_OR_RETURN(const std::string png, render::EncodePng(sheet));
  return WriteFile(request.sheet, png);
}

// "1,2,3" or "1:2"; false unless there are `count`.
bool ReadNumbers(const std::string& text, char separator, std::size_t count,
                 std::vector<double>& numbers) {
  numbers.clear();
  for (const auto word : absl::StrSplit(text, separator)) {
    if (!absl::SimpleAtod(word, &numbers.emplace_back())) return false;
  }
  return numbers.size() == count;
}

bool ReadOption(const std::string& option, const std::string& value, Request& request) {
  if (option == "--field")
    request.field = value;
  else if (option == "--unit")
    request.unit = value;
  else if (option == "--over")
    return absl::SimpleAtod(value, &request.over);
  else if (option == "--deform")
    return absl::SimpleAtod(value, &request.deform);
  else if (option == "--columns")
    return absl::SimpleAtoi(value, &request.columns);
  else if (option == "--width")
    return absl::SimpleAtoi(value, &request.width);
  else if (option == "--height")
    return absl::SimpleAtoi(value, &request.height);
  else if (option == "--range")
    return ReadNumbers(value, ':', 2, request.range);
  else if (option == "--from")
    return ReadNumbers(value, ',', 3, request.from);
  else
    return false;
  return true;
}

bool ReadArguments(int count, char** arguments, Request& request) {
  for (int i = 1; i < count; ++i) {
    const std::string word = arguments[i];
    if (word == "--mesh") {
      request.mesh = true;
    } else if (word == "--alike") {
      request.alike = true;
    } else if (word.starts_with("--")) {
      if (++i == count || !ReadOption(word, arguments[i], request)) return false;
    } else if (request.sheet.empty()) {
      request.sheet = word;
    } else {
      request.pictures.push_back(word);
    }
  }
  return !request.pictures.empty();
}

}  // namespace

int main(int count, char** arguments) {
  Request request;
  if (!ReadArguments(count, arguments, request)) {
    std::cerr << "Usage: field_pictures SHEET [--field NAME] [--unit TEXT] [--over NUMBER] "
                 "[--range LOW:HIGH] [--deform TIMES] [--mesh] [--alike] [--columns COUNT] "
                 "[--width PIXELS] [--height PIXELS] [--from X,Y,Z] CAPTION=FILE...\n";
    return 2;
  }
  const absl::Status made = Draw(request);
  if (!made.ok()) std::cerr << made << "\n";
  return made.ok() ? 0 : 1;
}
