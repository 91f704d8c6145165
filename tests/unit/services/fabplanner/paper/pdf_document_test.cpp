// PDF as another program reads it.
#include "services/fabplanner/paper/pdf_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/printed_pages.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(PdfDocumentTest, WritesTextsOfAnyScript) {
  auto document = PdfDocument::Begin("Tür <1> & łóżko");
  ASSERT_TRUE(document.ok()) << document.status();
  document->AddPage();
  document->Text(20, 30, PdfFace::kPlain, 12, "Größe 45 × 45 – łóżko, Привет (\\) <b>");
  document->AddPage();
  document->Text(20, 30, PdfFace::kBold, 12, "second");
  document->Bookmark("Tür");
  document->SelectPage(0);
  document->Text(20, 60, PdfFace::kBold, 12, "again");
  const auto pdf = document->Finish();
  ASSERT_TRUE(pdf.ok()) << pdf.status();
  EXPECT_THAT(*pdf, StartsWith("%PDF-1."));
  const auto pages = testing::TextPagesOf(*pdf);
  ASSERT_EQ(pages.size(), 2u);
  EXPECT_THAT(pages[0], HasSubstr("Größe 45 × 45 – łóżko, Привет (\\) <b>"));
  EXPECT_THAT(pages[0], HasSubstr("again"));
  EXPECT_THAT(pages[1], HasSubstr("second"));
}

TEST(PdfDocumentTest, TheSameDrawingIsTheSameFile) {
  const auto write = [] {
    auto document = PdfDocument::Begin("Table").value();
    document.AddPage();
    document.Line(10, 10, 20, 20, 0.2, kInk);
    document.Polygon({{10, 10}, {20, 10}, {20, 20}}, kPaleInk, kInk);
    document.Text(20, 30, PdfFace::kPlain, 12, "leg");
    return document.Finish().value();
  };
  EXPECT_EQ(write(), write());
}

TEST(PdfDocumentTest, WhatIsNoTextIsReplaced) {
  EXPECT_EQ(PrintableText("a\tb\x01\x7f"), "a b  ");
  EXPECT_EQ(PrintableText("ok \xff\xc3 \xe2\x82 end"), "ok ?? ? end");
  EXPECT_EQ(PrintableText("\xf0\x9f\x98\x80!"), "?!");  // beyond the basic plane
  EXPECT_EQ(PrintableText("\xed\xa0\x80"), "?");        // half of a pair
  EXPECT_EQ(PrintableText("∠ 30° ½"), "∠ 30° ½");
}

TEST(PdfDocumentTest, RefusesAPictureThatIsNone) {
  auto document = PdfDocument::Begin("Table").value();
  document.AddPage();
  EXPECT_EQ(document.Picture("no picture", 0, 0, 10, 10).code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_TRUE(document.Finish().ok());
}

TEST(PdfDocumentTest, WidthsGrowWithTextsAndSizes) {
  const auto document = PdfDocument::Begin("Table").value();
  const double width = document.TextWidth(PdfFace::kPlain, 10, "45 × 45");
  EXPECT_GT(width, 10);
  EXPECT_LT(width, 20);
  EXPECT_NEAR(document.TextWidth(PdfFace::kPlain, 20, "45 × 45"), 2 * width, 1e-9);
  EXPECT_GT(document.TextWidth(PdfFace::kBold, 10, "45 × 45"), width);
}

}  // namespace
}  // namespace mortise::fabplanner
