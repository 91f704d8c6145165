#include "cli/client/filter_options.h"

#include <google/protobuf/util/time_util.h>

#include <CLI/CLI.hpp>
#include <iterator>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"

namespace mortise::cli {
namespace {

struct TimeUnit {
  absl::string_view name;
  absl::Duration size;
};

// The units of times before now. A month is none: they differ, and "m" is left to nobody.
std::optional<absl::Duration> UnitCalled(absl::string_view name) {
  const TimeUnit units[] = {{"s", absl::Seconds(1)},
                            {"min", absl::Minutes(1)},
                            {"h", absl::Hours(1)},
                            {"d", absl::Hours(24)},
                            {"w", absl::Hours(7 * 24)}};
  for (const TimeUnit& unit : units) {
    if (unit.name == name) return unit.size;
  }
  return std::nullopt;
}

// "2h" as two hours; nothing for what has another form.
std::optional<absl::Duration> DurationOf(const std::string& text) {
  if (text.empty() || !absl::ascii_isdigit(static_cast<unsigned char>(text.front()))) {
    return std::nullopt;
  }
  const auto number = DecimalNumberPrefix(text);
  if (!number) return std::nullopt;
  const std::optional<absl::Duration> unit =
      UnitCalled(absl::StripAsciiWhitespace(absl::string_view(text).substr(number->length)));
  if (!unit) return std::nullopt;
  return number->value * *unit;
}

// A time as ISO 8601 writes it; nothing for what has another form.
std::optional<absl::Time> Iso8601(const std::string& text, absl::TimeZone zone) {
  // Of what ParseTime reads only that which ends in a zone says one; it takes blanks everywhere.
  if (text.find_first_of(" \t") != std::string::npos) return std::nullopt;
  constexpr const char* kForms[] = {"%E4Y-%m-%d", "%E4Y-%m-%dT%H:%M", "%E4Y-%m-%dT%H:%M:%E*S"};
  for (const char* const form : kForms) {
    absl::Time time;
    if (absl::ParseTime(form, text, zone, &time, nullptr)) return time;
    if (form == std::begin(kForms)[0]) continue;  // a date has no zone
    if (absl::ParseTime(absl::StrCat(form, "%Ez"), text, zone, &time, nullptr)) return time;
  }
  return std::nullopt;
}

// Whether contracts can say this time: years 1 to 9999.
bool IsInCalendar(absl::Time time) {
  const absl::TimeZone utc = absl::UTCTimeZone();
  return time >= absl::FromCivil(absl::CivilYear(1), utc) &&
         time < absl::FromCivil(absl::CivilYear(10000), utc);
}

absl::Status SetTime(const std::string& text, const std::string& flag, absl::Time now,
                     absl::TimeZone zone, google::protobuf::Timestamp* time) {
  MORTISE_ASSIGN_OR_RETURN(const absl::Time parsed, ParseTime(text, flag, now, zone));
  *time = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(parsed));
  return absl::OkStatus();
}

absl::Status AddLabel(const std::string& text, v1::ResourceFilter& filter) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || text.empty()) {
    return InvalidField("--label", absl::StrCat("'", text, "' is neither KEY=VALUE nor KEY"));
  }
  if (equals == text.size() - 1) {
    return InvalidField("--label", absl::StrCat("'", text,
                                                "' has no value; KEY alone asks for the label with "
                                                "any value"));
  }
  const std::string key = text.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
  if (filter.labels().contains(key)) {
    return InvalidField("--label", absl::StrCat("'", key, "' is there twice"));
  }
  (*filter.mutable_labels())[key] = value;
  return absl::OkStatus();
}

}  // namespace

void AddFilterOptions(CommandFlags& flags, FilterOptions& options) {
  flags.Add("--external-id", options.external_id,
            "Only those that another system knows by this, letter by letter", "filter.external_id");
  flags
      .Add("--label", options.labels,
           "Only those with this label: KEY=VALUE, or KEY with any value; again for more")
      ->allow_extra_args(false);
  flags.AlsoGives("--label", "filter.labels");  // by key, not by number
  flags.Add("--creator", options.creator, "Only those that this user made, such as ada",
            "filter.creator");
  flags.Add("--since", options.since,
            "Only those made since then: 2026-11-26, 2026-11-26T20:25, or 2h, 7d ago",
            "filter.created_from");
  flags.Add("--before", options.before, "Only those made before then, likewise",
            "filter.created_before");
}

absl::StatusOr<absl::Time> ParseTime(const std::string& text, const std::string& field,
                                     absl::Time now, absl::TimeZone zone) {
  std::optional<absl::Time> time = Iso8601(text, zone);
  if (const std::optional<absl::Duration> ago = DurationOf(text); !time && ago) time = now - *ago;
  if (!time) {
    return InvalidField(
        field, absl::StrCat("'", text,
                            "' is neither a date or time such as 2026-11-26, 2026-11-26T20:25 or "
                            "2026-11-26T20:25:30Z, nor a time before now such as 90s, 15min, 2h, "
                            "7d or 3w"));
  }
  if (!IsInCalendar(*time)) {
    return InvalidField(field, absl::StrCat("'", text, "' is not in the years 1 to 9999"));
  }
  return *time;
}

absl::StatusOr<v1::ResourceFilter> ParseFilter(const FilterOptions& options, absl::Time now,
                                               absl::TimeZone zone) {
  v1::ResourceFilter filter;
  filter.set_external_id(options.external_id);
  for (const std::string& label : options.labels) {
    MORTISE_RETURN_IF_ERROR(AddLabel(label, filter));
  }
  const bool is_name = options.creator.find('/') != std::string::npos;
  if (!options.creator.empty()) {
    filter.set_creator(is_name ? options.creator : absl::StrCat("users/", options.creator));
  }
  if (!options.since.empty()) {
    MORTISE_RETURN_IF_ERROR(
        SetTime(options.since, "--since", now, zone, filter.mutable_created_from()));
  }
  if (!options.before.empty()) {
    MORTISE_RETURN_IF_ERROR(
        SetTime(options.before, "--before", now, zone, filter.mutable_created_before()));
  }
  return filter;
}

absl::StatusOr<v1::ResourceFilter> ParseFilter(const FilterOptions& options) {
  return ParseFilter(options, absl::Now(), absl::LocalTimeZone());
}

}  // namespace mortise::cli
