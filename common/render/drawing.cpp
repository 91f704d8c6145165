// Drawings as SVG text, and on a grid of samples.
#include "common/render/drawing.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/text_escapes.h"

namespace mortise::render {
namespace {

using Points = Drawing::Points;

constexpr double kCapital = 0.72;  // height of a capital letter, of the font's size
constexpr int kSamples = 2;        // along each side of a pixel

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

absl::Status Check(const Drawing& drawing) {
  if (drawing.width() < 16 || drawing.width() > 10000) {
    return InvalidField("drawing.width", "must be within 16 to 10000");
  }
  if (drawing.height() < 16 || drawing.height() > 10000) {
    return InvalidField("drawing.height", "must be within 16 to 10000");
  }
  const auto finite = [](const Points& points) {
    return std::ranges::all_of(points, [](const Eigen::Vector2d& p) { return p.allFinite(); });
  };
  for (const auto& mark : drawing.marks()) {
    const bool is_finite =
        std::visit(Overloaded{[&](const Drawing::Line& line) { return finite(line.points); },
                              [](const Drawing::Disc& disc) { return disc.centre.allFinite(); },
                              [&](const Drawing::Area& area) { return finite(area.corners); }},
                   mark);
    if (!is_finite) return InvalidField("drawing", "a coordinate is not a finite number");
  }
  for (const Drawing::Text& text : drawing.texts()) {
    if (!text.position.allFinite()) {
      return InvalidField("drawing", "a coordinate is not a finite number");
    }
  }
  return absl::OkStatus();
}

std::string Listed(const Points& points) {
  std::string list;
  for (const Eigen::Vector2d& p : points) absl::StrAppendFormat(&list, "%.2f,%.2f ", p.x(), p.y());
  if (!list.empty()) list.pop_back();
  return list;
}

std::string MarkSvg(const Drawing::Line& line) {
  return absl::StrFormat(
      "<polyline points=\"%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"%.2f\" "
      "stroke-linecap=\"round\" stroke-linejoin=\"round\"/>\n",
      Listed(line.points), HexColor(line.color), line.width);
}

std::string MarkSvg(const Drawing::Disc& disc) {
  return absl::StrFormat("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"%s\"/>\n",
                         disc.centre.x(), disc.centre.y(), disc.radius, HexColor(disc.color));
}

std::string MarkSvg(const Drawing::Area& area) {
  return absl::StrFormat("<polygon points=\"%s\" fill=\"%s\"/>\n", Listed(area.corners),
                         HexColor(area.color));
}

std::string TextSvg(const Drawing::Text& text) {
  const char* const anchor = text.anchor == Drawing::Anchor::kStart    ? "start"
                             : text.anchor == Drawing::Anchor::kMiddle ? "middle"
                                                                       : "end";
  return absl::StrFormat(
      "<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.1f\" text-anchor=\"%s\" fill=\"%s\">%s</text>\n",
      text.position.x(), text.position.y(), text.size, anchor, HexColor(text.color),
      EscapeXml(text.text));
}

// Samples of a drawing, `scale` for each of its pixels.
class Samples {
 public:
  Samples(int width, int height, double scale)
      : scale_(scale),
        image_(static_cast<int>(width * scale), static_cast<int>(height * scale), {1, 1, 1}) {}

  void Draw(const Drawing::Disc& disc) {
    FillDisc(scale_ * disc.centre, scale_ * disc.radius, disc.color);
  }

  void Draw(const Drawing::Area& area) {
    Points corners = area.corners;
    for (Eigen::Vector2d& corner : corners) corner *= scale_;
    Fill(corners, area.color);
  }

  // As a bar for each piece, and a disc at each end.
  void Draw(const Drawing::Line& line) {
    const double half = 0.5 * scale_ * line.width;
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Eigen::Vector2d to = scale_ * line.points[i];
      FillDisc(to, half, line.color);
      if (i == 0) continue;
      const Eigen::Vector2d from = scale_ * line.points[i - 1];
      const Eigen::Vector2d along = to - from;
      if (!(along.norm() > 0)) continue;
      const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized() * half;
      Fill({from + across, to + across, to - across, from - across}, line.color);
    }
  }

  Image Reduced() const {
    Image reduced(image_.width / kSamples, image_.height / kSamples, {1, 1, 1});
    for (int y = 0; y < reduced.height; ++y) {
      for (int x = 0; x < reduced.width; ++x) Average(x, y, reduced);
    }
    return reduced;
  }

 private:
  void Average(int x, int y, Image& reduced) const {
    for (int channel = 0; channel < 3; ++channel) {
      int sum = 0;
      for (int j = 0; j < kSamples; ++j) {
        for (int i = 0; i < kSamples; ++i) {
          sum += image_.pixels[3 * Index(kSamples * x + i, kSamples * y + j, image_.width) +
                               static_cast<std::size_t>(channel)];
        }
      }
      reduced.pixels[3 * Index(x, y, reduced.width) + static_cast<std::size_t>(channel)] =
          static_cast<std::uint8_t>(sum / (kSamples * kSamples));
    }
  }

  static std::size_t Index(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }

  // The samples of a row whose centres lie between two places.
  void FillRow(int y, double from, double to, const Color& color) {
    const int first = std::max(0, static_cast<int>(std::ceil(from - 0.5)));
    const int last = std::min(image_.width - 1, static_cast<int>(std::floor(to - 0.5)));
    for (int x = first; x <= last; ++x) image_.Set(x, y, color);
  }

  template <typename Row>
  void ForRows(double top, double bottom, const Row& row) {
    const int first = std::max(0, static_cast<int>(std::ceil(top - 0.5)));
    const int last = std::min(image_.height - 1, static_cast<int>(std::floor(bottom - 0.5)));
    for (int y = first; y <= last; ++y) row(y, y + 0.5);
  }

  void FillDisc(const Eigen::Vector2d& centre, double radius, const Color& color) {
    ForRows(centre.y() - radius, centre.y() + radius, [&](int row, double y) {
      const double half = std::sqrt(std::max(0.0, radius * radius - std::pow(y - centre.y(), 2)));
      FillRow(row, centre.x() - half, centre.x() + half, color);
    });
  }

  // By the crossings of each row with the sides.
  void Fill(const Points& corners, const Color& color) {
    if (corners.size() < 3) return;
    const auto [top, bottom] =
        std::ranges::minmax(corners, {}, [](const Eigen::Vector2d& p) { return p.y(); });
    std::vector<double> crossings;
    ForRows(top.y(), bottom.y(), [&](int row, double y) {
      crossings.clear();
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
        if ((a.y() <= y) == (b.y() <= y)) continue;
        crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
      std::ranges::sort(crossings);
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
        FillRow(row, crossings[i], crossings[i + 1], color);
      }
    });
  }

  double scale_;
  Image image_;
};

}  // namespace

absl::StatusOr<std::string> DrawingSvg(const Drawing& drawing) {
  MORTISE_RETURN_IF_ERROR(Check(drawing));
  std::string svg = absl::StrFormat(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
      "font-family=\"Helvetica, Arial, sans-serif\">\n"
      "<rect width=\"100%%\" height=\"100%%\" fill=\"#ffffff\"/>\n",
      drawing.width(), drawing.height(), drawing.width(), drawing.height());
  for (const auto& mark : drawing.marks()) {
    svg += std::visit([](const auto& one) { return MarkSvg(one); }, mark);
  }
  for (const Drawing::Text& text : drawing.texts()) svg += TextSvg(text);
  return svg + "</svg>\n";
}

absl::StatusOr<Image> DrawingImage(const Drawing& drawing, int scale) {
  MORTISE_RETURN_IF_ERROR(Check(drawing));
  if (scale < 1 || scale > 4) return InvalidField("scale", "must be within 1 to 4");
  Samples samples(drawing.width(), drawing.height(), scale * kSamples);
  for (const auto& mark : drawing.marks()) {
    std::visit([&](const auto& one) { samples.Draw(one); }, mark);
  }
  Image image = samples.Reduced();
  for (const Drawing::Text& text : drawing.texts()) {
    const double capital = kCapital * text.size * scale;
    const double width = TextWidth(capital, text.text);
    const double shift = text.anchor == Drawing::Anchor::kStart    ? 0
                         : text.anchor == Drawing::Anchor::kMiddle ? 0.5
                                                                   : 1;
    DrawText(image, scale * text.position.x() - shift * width, scale * text.position.y() - capital,
             capital, text.color, text.text);
  }
  return image;
}

std::string Shortened(const std::string& text, double size, double width) {
  if (TextWidth(kCapital * size, text) <= width) return text;
  std::string kept = text;
  do {
    kept.pop_back();
    // Not within a character of several bytes.
    while (!kept.empty() && (static_cast<unsigned char>(kept.back()) & 0xC0) == 0x80) {
      kept.pop_back();
    }
    if (!kept.empty() && (static_cast<unsigned char>(kept.back()) & 0xC0) == 0xC0) kept.pop_back();
  } while (!kept.empty() && TextWidth(kCapital * size, absl::StrCat(kept, "..")) > width);
  return absl::StrCat(kept, "..");
}

}  // namespace mortise::render
