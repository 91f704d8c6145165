#include "cli/files/ground_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/files/csv_table.h"
#include "common/terrain/height_field.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMostFaults = 20;
constexpr double kOffGrid = 0.02;  // of the spacing, by which rounded numbers may miss a line
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

absl::Status TooManyHeights(const std::string& origin, std::int64_t columns, std::int64_t rows) {
  return InvalidField(origin, absl::StrCat("makes a grid of ", columns, " x ", rows, " heights; ",
                                           terrain::HeightField::kMaxHeights, " are accepted"));
}

bool IsTooLarge(std::int64_t columns, std::int64_t rows) {
  return columns * rows > static_cast<std::int64_t>(terrain::HeightField::kMaxHeights);
}

// ---- Points -------------------------------------------------------------------------------------

struct SurveyedPoint {
  std::array<double, 3> place;
  int line = 0;
};

// The lines of a grid along an axis.
struct GridLines {
  double first = 0;
  double spacing = 1;
  std::int64_t count = 0;

  std::int64_t NumberOf(double at) const { return std::llround((at - first) / spacing); }
};

// Which cells of a row have x, y and the height: by the heading, if there is one.
absl::StatusOr<std::array<std::size_t, 3>> ColumnsOf(const parametric::CsvRow& first,
                                                     const std::string& origin) {
  std::array<std::optional<std::size_t>, 3> columns;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::string heading = absl::AsciiStrToLower(absl::StripAsciiWhitespace(first[i].text));
    if (heading == "x") columns[0] = i;
    if (heading == "y") columns[1] = i;
    if (heading == "z" || heading == "height") columns[2] = i;
  }
  if (columns[0] && columns[1] && columns[2]) {
    return std::array<std::size_t, 3>{*columns[0], *columns[1], *columns[2]};
  }
  return InvalidField(absl::StrCat(origin, ": ", parametric::PlaceOf(first.front())),
                      "is neither a point, as 'x,y,z', nor a heading with 'x', 'y' and 'z'");
}

absl::StatusOr<std::vector<SurveyedPoint>> PointsOf(std::string_view text,
                                                    const std::string& origin) {
  const parametric::CsvTable table = parametric::ParseCsv(text);
  std::vector<FieldViolation> faults;
  for (const FieldViolation& finding : table.findings) {
    faults.push_back({absl::StrCat(origin, ": ", finding.field), finding.message});
  }
  if (!faults.empty()) return InvalidFields(faults);
  if (table.rows.empty()) return InvalidField(origin, "has no points");
  const parametric::CsvRow& first = table.rows.front();
  const bool has_heading = !parametric::ParseCsvNumber(first.front().text).ok();
  std::array<std::size_t, 3> columns = {0, 1, 2};
  if (has_heading || first.size() < 3) {
    MORTISE_ASSIGN_OR_RETURN(columns, ColumnsOf(first, origin));
  }
  std::vector<SurveyedPoint> points;
  for (std::size_t i = has_heading ? 1 : 0; i < table.rows.size(); ++i) {
    SurveyedPoint point{{}, table.rows[i].front().line};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const parametric::CsvCell& cell = table.rows[i][columns[axis]];
      const absl::StatusOr<double> number = parametric::ParseCsvNumber(cell.text);
      if (number.ok()) {
        point.place[axis] = *number;
      } else if (faults.size() < kMostFaults) {
        faults.push_back({absl::StrCat(origin, ": ", parametric::PlaceOf(cell)),
                          std::string(number.status().message())});
      }
    }
    points.push_back(point);
  }
  if (!faults.empty()) return InvalidFields(faults);
  return points;
}

// The distance of neighbouring lines, of which some may have no points.
double SpacingOf(const std::vector<double>& lines) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < lines.size(); ++i) least = std::min(least, lines[i] - lines[i - 1]);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (lines[i] - lines[i - 1] > 1.5 * least) continue;
    sum += lines[i] - lines[i - 1];
    ++count;
  }
  return sum / count;
}

absl::StatusOr<GridLines> LinesAlong(std::size_t axis, const std::vector<SurveyedPoint>& points,
                                     const std::string& origin) {
  const char* const name = axis == 0 ? "x" : "y";
  std::vector<double> lines;
  for (const SurveyedPoint& point : points) lines.push_back(point.place[axis]);
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  if (lines.size() < 2) {
    return InvalidField(origin, absl::StrCat("has points at one ", name, " only"));
  }
  const double spacing = SpacingOf(lines);
  GridLines grid{lines.front(), spacing,
                 std::llround((lines.back() - lines.front()) / spacing) + 1};
  grid.spacing = (lines.back() - lines.front()) / static_cast<double>(grid.count - 1);
  for (const SurveyedPoint& point : points) {
    const double at = (point.place[axis] - grid.first) / grid.spacing;
    if (std::abs(at - std::round(at)) <= kOffGrid) continue;
    return InvalidField(
        absl::StrCat(origin, ": line ", point.line),
        absl::StrCat(name, " = ", point.place[axis], " lies on no grid with lines ", grid.spacing,
                     " apart from ", grid.first,
                     ": give points that lie on none as triangles, in an OBJ or STL file"));
  }
  return grid;
}

// ---- ESRI ASCII grids ---------------------------------------------------------------------------

struct Word {
  std::string_view text;
  int line = 0;
};

std::vector<Word> WordsOf(std::string_view text) {
  std::vector<Word> words;
  int line = 0;
  for (const absl::string_view row :
       absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
    ++line;
    for (const absl::string_view word :
         absl::StrSplit(row, absl::ByAnyChar(" \t\r"), absl::SkipEmpty())) {
      words.push_back({{word.data(), word.size()}, line});
    }
  }
  return words;
}

// Reads the words of a grid one after the other.
class EsriReader {
 public:
  EsriReader(std::string_view text, std::string origin)
      : words_(WordsOf(text)), origin_(std::move(origin)) {}

  absl::StatusOr<v1::HeightGrid> Read() {
    MORTISE_RETURN_IF_ERROR(ReadHeader());
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t columns, CountOf("ncols"));
    MORTISE_ASSIGN_OR_RETURN(const std::int64_t rows, CountOf("nrows"));
    if (IsTooLarge(columns, rows)) return TooManyHeights(origin_, columns, rows);
    MORTISE_ASSIGN_OR_RETURN(const double spacing, Positive("cellsize"));
    v1::HeightGrid grid;
    MORTISE_ASSIGN_OR_RETURN(const double x, FirstOf("xll", spacing));
    MORTISE_ASSIGN_OR_RETURN(const double y, FirstOf("yll", spacing));
    grid.set_x(x);
    grid.set_y(y);
    grid.set_x_spacing(spacing);
    grid.set_y_spacing(spacing);
    grid.set_columns(static_cast<int>(columns));
    MORTISE_ASSIGN_OR_RETURN(const std::vector<double> heights, ReadHeights(columns * rows));
    // Rows of the file go from north to south.
    for (std::int64_t row = rows - 1; row >= 0; --row) {
      const auto begin = heights.begin() + row * columns;
      grid.mutable_heights()->Add(begin, begin + columns);
    }
    return grid;
  }

 private:
  std::string At(int line) const { return absl::StrCat(origin_, ": line ", line); }

  absl::StatusOr<double> NumberAt(std::size_t word) const {
    const absl::StatusOr<double> number =
        parametric::ParseCsvNumber(std::string(words_[word].text));
    if (number.ok()) return number;
    return InvalidField(At(words_[word].line), absl::StrCat("'", std::string(words_[word].text),
                                                            "' ", number.status().message()));
  }

  absl::Status ReadHeader() {
    while (next_ < words_.size() &&
           absl::ascii_isalpha(static_cast<unsigned char>(words_[next_].text[0]))) {
      const std::string key = absl::AsciiStrToLower(
          absl::string_view(words_[next_].text.data(), words_[next_].text.size()));
      if (key == "nan") break;
      if (next_ + 1 == words_.size()) return InvalidField(At(words_[next_].line), "ends the file");
      MORTISE_ASSIGN_OR_RETURN(const double value, NumberAt(next_ + 1));
      header_[key] = value;
      next_ += 2;
    }
    return absl::OkStatus();
  }

  absl::StatusOr<double> Positive(const std::string& key) const {
    const auto found = header_.find(key);
    if (found == header_.end()) {
      return InvalidField(origin_, absl::StrCat("has no '", key, "' at its beginning"));
    }
    if (found->second > 0) return found->second;
    return InvalidField(origin_, absl::StrCat("'", key, "' must be greater than 0"));
  }

  absl::StatusOr<std::int64_t> CountOf(const std::string& key) const {
    MORTISE_ASSIGN_OR_RETURN(const double count, Positive(key));
    if (count >= 2 && count <= 100'000 && count == std::round(count)) {
      return static_cast<std::int64_t>(count);
    }
    return InvalidField(origin_, absl::StrCat("'", key, "' must be a whole number from 2"));
  }

  // Where the first line of the grid is: the middle of a cell.
  absl::StatusOr<double> FirstOf(const std::string& key, double spacing) const {
    if (const auto corner = header_.find(key + "corner"); corner != header_.end()) {
      return corner->second + spacing / 2;
    }
    if (const auto center = header_.find(key + "center"); center != header_.end()) {
      return center->second;
    }
    return InvalidField(origin_, absl::StrCat("has neither '", key, "corner' nor '", key,
                                              "center' at its beginning"));
  }

  absl::StatusOr<std::vector<double>> ReadHeights(std::int64_t count) {
    const auto there = static_cast<std::int64_t>(words_.size() - next_);
    if (there != count) {
      return InvalidField(
          there < count ? origin_ : At(words_[next_ + static_cast<std::size_t>(count)].line),
          absl::StrCat("there are ", there, " heights, where the grid has ", count));
    }
    const auto given = header_.find("nodata_value");
    const double unknown = given == header_.end() ? -9999 : given->second;
    std::vector<double> heights;
    for (; next_ < words_.size(); ++next_) {
      MORTISE_ASSIGN_OR_RETURN(const double height, NumberAt(next_));
      heights.push_back(height == unknown ? kUnknown : height);
    }
    return heights;
  }

  const std::vector<Word> words_;
  const std::string origin_;
  std::size_t next_ = 0;
  std::map<std::string, double> header_;
};

}  // namespace

absl::StatusOr<v1::HeightGrid> ParseGroundPoints(std::string_view text, const std::string& origin) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<SurveyedPoint> points, PointsOf(text, origin));
  MORTISE_ASSIGN_OR_RETURN(const GridLines columns, LinesAlong(0, points, origin));
  MORTISE_ASSIGN_OR_RETURN(const GridLines rows, LinesAlong(1, points, origin));
  if (IsTooLarge(columns.count, rows.count)) {
    return TooManyHeights(origin, columns.count, rows.count);
  }
  v1::HeightGrid grid;
  grid.set_x(columns.first);
  grid.set_y(rows.first);
  grid.set_x_spacing(columns.spacing);
  grid.set_y_spacing(rows.spacing);
  grid.set_columns(static_cast<int>(columns.count));
  const auto count = static_cast<std::size_t>(columns.count * rows.count);
  std::vector<double> heights(count, kUnknown);
  std::vector<int> lines(count);  // that gave them
  for (const SurveyedPoint& point : points) {
    const auto index = static_cast<std::size_t>(rows.NumberOf(point.place[1]) * columns.count +
                                                columns.NumberOf(point.place[0]));
    if (lines[index] != 0) {
      return InvalidField(absl::StrCat(origin, ": line ", point.line),
                          absl::StrCat("the point is there already, in line ", lines[index]));
    }
    lines[index] = point.line;
    heights[index] = point.place[2];
  }
  grid.mutable_heights()->Add(heights.begin(), heights.end());
  return grid;
}

absl::StatusOr<v1::HeightGrid> ParseEsriGrid(std::string_view text, const std::string& origin) {
  return EsriReader(text, origin).Read();
}

}  // namespace mortise::cli
