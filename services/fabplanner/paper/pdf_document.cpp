#include "services/fabplanner/paper/pdf_document.h"

#include <hpdf.h>

#include <filesystem>
#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

constexpr double kPoints = 72 / 25.4;  // of a millimetre
constexpr char kUtf8[] = "UTF-8";

float Points(double millimetres) { return static_cast<float>(millimetres * kPoints); }

// The length of the letter of the basic plane that begins at `at`, in bytes; 0 where there is none.
std::size_t LetterAt(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
  const unsigned first = byte(at);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return follows(at + 1) ? 2 : 0;
  if (first < 0xe0 || first >= 0xf0 || !follows(at + 1) || !follows(at + 2)) return 0;
  const unsigned letter = (first & 0xf) << 12 | (byte(at + 1) & 0x3f) << 6 | (byte(at + 2) & 0x3f);
  return letter >= 0x800 && (letter < 0xd800 || letter > 0xdfff) ? 3 : 0;
}

}  // namespace

std::string PrintableText(std::string_view text) {
  std::string printable;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = LetterAt(text, at);
    if (length == 0) {
      printable += '?';
      // The rest of what was no letter.
      do ++at;
      while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80);
      continue;
    }
    const auto first = static_cast<unsigned char>(text[at]);
    if (first < 0x20 || first == 0x7f) {
      printable += ' ';
    } else {
      printable.append(text.substr(at, length));
    }
    at += length;
  }
  return printable;
}

// libharu's document, which keeps its first error: what fails later, fails in Finish.
class PdfDocument::Pages {
 public:
  Pages() : document_(HPDF_New(nullptr, nullptr)) {}
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;
  ~Pages() {
    if (document_ != nullptr) HPDF_Free(document_);
  }

  absl::Status Begin(const std::string& title) {
    if (document_ == nullptr) return absl::ResourceExhaustedError("there is no memory for a PDF");
    HPDF_SetCompressionMode(document_, HPDF_COMP_ALL);
    HPDF_UseUTFEncodings(document_);
    HPDF_SetCurrentEncoder(document_, kUtf8);
    HPDF_SetInfoAttr(document_, HPDF_INFO_TITLE, PrintableText(title).c_str());
    HPDF_SetInfoAttr(document_, HPDF_INFO_CREATOR, "mortise plan");
    HPDF_SetPageMode(document_, HPDF_PAGE_MODE_USE_OUTLINE);
    MORTISE_ASSIGN_OR_RETURN(faces_[0], Load(MORTISE_PLAIN_FONT));
    MORTISE_ASSIGN_OR_RETURN(faces_[1], Load(MORTISE_BOLD_FONT));
    return Check();
  }

  absl::Status Check() const {
    const HPDF_STATUS error = HPDF_GetError(document_);
    if (error == HPDF_OK) return absl::OkStatus();
    return absl::InternalError(
        absl::StrFormat("a PDF cannot be written: libharu's error 0x%04x, detail %d", error,
                        HPDF_GetErrorDetail(document_)));
  }

  absl::StatusOr<HPDF_Image> ImageOf(const std::string& png) {
    const auto known = images_.find(png);
    if (known != images_.end()) return known->second;
    MORTISE_RETURN_IF_ERROR(Check());
    const HPDF_Image image =
        HPDF_LoadPngImageFromMem(document_, reinterpret_cast<const HPDF_BYTE*>(png.data()),
                                 static_cast<HPDF_UINT>(png.size()));
    if (image == nullptr) {
      HPDF_ResetError(document_);
      return InvalidField("picture", "is no PNG that can be read");
    }
    images_.emplace(png, image);
    return image;
  }

  HPDF_Doc document() const { return document_; }
  HPDF_Font face(PdfFace face) const { return faces_[face == PdfFace::kBold ? 1 : 0]; }
  HPDF_Page page() const { return page_; }

  void Add() {
    page_ = HPDF_AddPage(document_);
    HPDF_Page_SetSize(page_, HPDF_PAGE_SIZE_A4, HPDF_PAGE_PORTRAIT);
    list_.push_back(page_);
  }
  void Select(int page) { page_ = list_.at(static_cast<std::size_t>(page)); }
  int count() const { return static_cast<int>(list_.size()); }

 private:
  absl::StatusOr<HPDF_Font> Load(const char* path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
      return absl::FailedPreconditionError(absl::StrCat("documents on paper need the font ", path,
                                                        " (Debian's package fonts-dejavu-core)"));
    }
    const char* name = HPDF_LoadTTFontFromFile(document_, path, HPDF_TRUE);
    MORTISE_RETURN_IF_ERROR(Check());
    return HPDF_GetFont(document_, name, kUtf8);
  }

  HPDF_Doc document_;
  HPDF_Font faces_[2] = {};
  HPDF_Page page_ = nullptr;
  std::vector<HPDF_Page> list_;
  std::map<std::string, HPDF_Image> images_;
};

PdfDocument::PdfDocument(std::unique_ptr<Pages> pages) : pages_(std::move(pages)) {}
PdfDocument::PdfDocument(PdfDocument&&) noexcept = default;
PdfDocument& PdfDocument::operator=(PdfDocument&&) noexcept = default;
PdfDocument::~PdfDocument() = default;

absl::StatusOr<PdfDocument> PdfDocument::Begin(const std::string& title) {
  auto pages = std::make_unique<Pages>();
  MORTISE_RETURN_IF_ERROR(pages->Begin(title));
  return PdfDocument(std::move(pages));
}

void PdfDocument::AddPage() { pages_->Add(); }
int PdfDocument::pages() const { return pages_->count(); }
void PdfDocument::SelectPage(int page) { pages_->Select(page); }

double PdfDocument::TextWidth(PdfFace face, double size, const std::string& text) const {
  const std::string printable = PrintableText(text);
  const HPDF_TextWidth width =
      HPDF_Font_TextWidth(pages_->face(face), reinterpret_cast<const HPDF_BYTE*>(printable.data()),
                          static_cast<HPDF_UINT>(printable.size()));
  return width.width * size / 1000 / kPoints;
}

void PdfDocument::Text(double x, double y, PdfFace face, double size, const std::string& text,
                       const render::Color& color) {
  const HPDF_Page page = pages_->page();
  HPDF_Page_SetRGBFill(page, static_cast<float>(color.red), static_cast<float>(color.green),
                       static_cast<float>(color.blue));
  HPDF_Page_BeginText(page);
  HPDF_Page_SetFontAndSize(page, pages_->face(face), static_cast<float>(size));
  HPDF_Page_TextOut(page, Points(x), Points(kPaperHeight - y), PrintableText(text).c_str());
  HPDF_Page_EndText(page);
}

void PdfDocument::Line(double x0, double y0, double x1, double y1, double width,
                       const render::Color& color) {
  const HPDF_Page page = pages_->page();
  HPDF_Page_SetRGBStroke(page, static_cast<float>(color.red), static_cast<float>(color.green),
                         static_cast<float>(color.blue));
  HPDF_Page_SetLineWidth(page, Points(width));
  HPDF_Page_MoveTo(page, Points(x0), Points(kPaperHeight - y0));
  HPDF_Page_LineTo(page, Points(x1), Points(kPaperHeight - y1));
  HPDF_Page_Stroke(page);
}

void PdfDocument::Polygon(const std::vector<Eigen::Vector2d>& points, const render::Color& fill,
                          const render::Color& border) {
  if (points.size() < 3) return;
  const HPDF_Page page = pages_->page();
  HPDF_Page_SetRGBFill(page, static_cast<float>(fill.red), static_cast<float>(fill.green),
                       static_cast<float>(fill.blue));
  HPDF_Page_SetRGBStroke(page, static_cast<float>(border.red), static_cast<float>(border.green),
                         static_cast<float>(border.blue));
  HPDF_Page_SetLineWidth(page, Points(0.2));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float x = Points(points[i].x()), y = Points(kPaperHeight - points[i].y());
    if (i == 0) HPDF_Page_MoveTo(page, x, y);
    if (i > 0) HPDF_Page_LineTo(page, x, y);
  }
  HPDF_Page_ClosePathFillStroke(page);
}

absl::Status PdfDocument::Picture(const std::string& png, double x, double y, double width,
                                  double height) {
  MORTISE_ASSIGN_OR_RETURN(const HPDF_Image image, pages_->ImageOf(png));
  HPDF_Page_DrawImage(pages_->page(), image, Points(x), Points(kPaperHeight - y - height),
                      Points(width), Points(height));
  return absl::OkStatus();
}

void PdfDocument::Modules(const ModuleSquare& square, double x, double y, double side) {
  // A picture of one bit a module; rows end on whole bytes.
  const int row = (square.side + 7) / 8;
  std::vector<HPDF_BYTE> bits(static_cast<std::size_t>(row) * square.side, 0xff);
  for (int i = 0; i < square.side * square.side; ++i) {
    if (!square.dark[static_cast<std::size_t>(i)]) continue;
    const int column = i % square.side;
    bits[static_cast<std::size_t>(i / square.side * row + column / 8)] &=
        static_cast<HPDF_BYTE>(~(0x80 >> column % 8));
  }
  const auto count = static_cast<HPDF_UINT>(square.side);
  const HPDF_Image image = HPDF_LoadRawImageFromMem(pages_->document(), bits.data(), count, count,
                                                    HPDF_CS_DEVICE_GRAY, 1);
  HPDF_Page_DrawImage(pages_->page(), image, Points(x), Points(kPaperHeight - y - side),
                      Points(side), Points(side));
}

void PdfDocument::Bookmark(const std::string& title) {
  const HPDF_Outline outline =
      HPDF_CreateOutline(pages_->document(), nullptr, PrintableText(title).c_str(),
                         HPDF_GetEncoder(pages_->document(), kUtf8));
  HPDF_Outline_SetDestination(outline, HPDF_Page_CreateDestination(pages_->page()));
}

absl::StatusOr<std::string> PdfDocument::Finish() {
  MORTISE_RETURN_IF_ERROR(pages_->Check());
  HPDF_SaveToStream(pages_->document());
  MORTISE_RETURN_IF_ERROR(pages_->Check());
  std::string bytes(HPDF_GetStreamSize(pages_->document()), '\0');
  HPDF_UINT32 size = static_cast<HPDF_UINT32>(bytes.size());
  HPDF_ResetStream(pages_->document());
  HPDF_ReadFromStream(pages_->document(), reinterpret_cast<HPDF_BYTE*>(bytes.data()), &size);
  bytes.resize(size);
  MORTISE_RETURN_IF_ERROR(pages_->Check());
  return bytes;
}

}  // namespace mortise::fabplanner
