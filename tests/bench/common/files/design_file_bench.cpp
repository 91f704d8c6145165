// How fast items are read from CSV and JSON, and checked: bytes a second, items a second.
#include <benchmark/benchmark.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "common/design/template_validation.h"
#include "common/files/design_file.h"
#include "common/files/template_codec.h"

namespace mortise::parametric {
namespace {

constexpr int kItems = 5000;

std::string Csv() {
  std::string text =
      "name,title,kind,material,standard,length_mm,width_mm,thickness_mm,measure.head_height_mm,"
      "price,currency,price_date\n";
  for (int i = 0; i < kItems; ++i) {
    absl::StrAppend(&text, "items/bolt-", i, ",\"Bolt, number ", i,
                    "\",BOLT,materials/steel,ISO 4014,", 20 + i % 100,
                    ",8,8,5.3,0.31,EUR,2026-01-15\n");
  }
  return text;
}

std::string Json() {
  std::string text = "[\n";
  for (int i = 0; i < kItems; ++i) {
    absl::StrAppend(
        &text, i == 0 ? "" : ",\n", "{\"name\": \"items/bolt-", i,
        "\", \"title\": \"Bolt\", \"kind\": \"BOLT\", \"material\": \"materials/steel\"",
        ", \"dimensions\": [{\"axis\": \"X\", \"size\": 0.04}, {\"axis\": \"Y\", ",
        "\"size\": 0.008}, {\"axis\": \"Z\", \"size\": 0.008}]}");
  }
  return text + "\n]\n";
}

void Read(benchmark::State& state, const std::string& text, DesignFile (*parse)(std::string_view)) {
  for (auto _ : state) {
    const DesignFile file = parse(text);
    if (file.items.size() != kItems || !file.findings.empty()) state.SkipWithError("not read");
    benchmark::DoNotOptimize(file);
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(text.size()) * state.iterations());
  state.SetItemsProcessed(kItems * state.iterations());
}

void ReadCsv(benchmark::State& state) { Read(state, Csv(), &ParseDesignCsv); }
void ReadJson(benchmark::State& state) { Read(state, Json(), &ParseDesignJson); }
BENCHMARK(ReadCsv)->Unit(benchmark::kMillisecond);
BENCHMARK(ReadJson)->Unit(benchmark::kMillisecond);

void CheckItems(benchmark::State& state) {
  const DesignFile file = ParseDesignCsv(Csv());
  Material steel;
  steel.name = "materials/steel";
  for (auto _ : state) {
    for (const auto& placed : file.items) {
      const auto item = FromProto(placed.message);
      if (!item.ok() || !ValidateItem(*item, {steel}).empty()) state.SkipWithError("not valid");
    }
  }
  state.SetItemsProcessed(kItems * state.iterations());
}
BENCHMARK(CheckItems)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mortise::parametric

BENCHMARK_MAIN();
