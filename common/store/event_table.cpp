#include "common/store/event_table.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/store/limits.h"

namespace mortise::store {
namespace {

constexpr int kMaxRead = 100000;

// Columns: number, epoch, time, type, subject, payload, trace_id.
NumberedEvent EventOf(SqlRow& row) {
  return {.epoch = row[1].integer,
          .number = row[0].integer,
          .time = absl::FromUnixMicros(row[2].integer),
          .type = std::move(row[3].text),
          .subject = std::move(row[4].text),
          .payload = std::move(row[5].text),
          .trace_id = std::move(row[6].text)};
}

absl::StatusOr<int64_t> OnlyInteger(absl::StatusOr<SqlResult> result) {
  if (!result.ok()) return result.status();
  if (result->rows.size() != 1) return StorageFailed("event_stream", "its row is missing");
  return result->rows[0][0].integer;
}

absl::Status Superseded(int64_t epoch, int64_t current) {
  return WithDetail(absl::AbortedError(absl::StrCat("epoch ", epoch, " of the event stream ended; ",
                                                    current, " has begun")),
                    {"RELAY_SUPERSEDED", ""});
}

}  // namespace

absl::Status EventTable::Append(const NewEvent& event, absl::Time now) {
  MORTISE_RETURN_IF_ERROR(CheckRequiredName("type", event.type));
  MORTISE_RETURN_IF_ERROR(CheckName("subject", event.subject));
  MORTISE_RETURN_IF_ERROR(CheckName("trace_id", event.trace_id));
  MORTISE_RETURN_IF_ERROR(CheckPayload("payload", event.payload));
  return connection_
      ->Run(
          "INSERT INTO outbox (time, type, subject, payload, trace_id)"
          " VALUES ($1, $2, $3, $4, $5)",
          {absl::ToUnixMicros(now), event.type, event.subject, SqlBytes{event.payload},
           event.trace_id})
      .status();
}

absl::StatusOr<std::vector<NumberedEvent>> EventTable::Read(int64_t after_number, int limit) {
  MORTISE_RETURN_IF_ERROR(CheckLimit("limit", limit, kMaxRead));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult result,
      connection_->Run("SELECT number, epoch, time, type, subject, payload, trace_id FROM events"
                       " WHERE number > $1 ORDER BY number LIMIT $2",
                       {after_number, int64_t{limit}}));
  std::vector<NumberedEvent> events;
  events.reserve(result.rows.size());
  for (SqlRow& row : result.rows) events.push_back(EventOf(row));
  return events;
}

absl::StatusOr<int64_t> EventTable::LatestNumber() {
  return OnlyInteger(connection_->Run("SELECT latest_number FROM event_stream"));
}

absl::StatusOr<int64_t> EventTable::Epoch() {
  return OnlyInteger(connection_->Run("SELECT epoch FROM event_stream"));
}

absl::StatusOr<int64_t> EventTable::BeginEpoch(absl::Time now) {
  MORTISE_ASSIGN_OR_RETURN(
      const int64_t last,
      OnlyInteger(connection_->Run("SELECT epoch FROM event_stream FOR UPDATE")));
  const int64_t epoch = std::max(last + 1, absl::ToUnixMillis(now));
  MORTISE_RETURN_IF_ERROR(connection_->Run("UPDATE event_stream SET epoch = $1", {epoch}).status());
  return epoch;
}

absl::StatusOr<std::vector<NumberedEvent>> EventTable::Number(int64_t epoch, int limit) {
  MORTISE_RETURN_IF_ERROR(CheckLimit("limit", limit, kMaxRead));
  MORTISE_ASSIGN_OR_RETURN(
      SqlResult stream,
      connection_->Run("SELECT epoch, latest_number FROM event_stream FOR UPDATE"));
  if (stream.rows.size() != 1) return StorageFailed("event_stream", "its row is missing");
  if (stream.rows[0][0].integer != epoch) return Superseded(epoch, stream.rows[0][0].integer);
  const int64_t latest = stream.rows[0][1].integer;

  MORTISE_ASSIGN_OR_RETURN(
      SqlResult waiting,
      connection_->Run("SELECT id, id, time, type, subject, payload, trace_id FROM outbox"
                       " ORDER BY id LIMIT $1",
                       {int64_t{limit}}));
  std::vector<NumberedEvent> events;
  if (waiting.rows.empty()) return events;
  const int64_t last_id = waiting.rows.back()[0].integer;
  events.reserve(waiting.rows.size());
  for (SqlRow& row : waiting.rows) {
    NumberedEvent& event = events.emplace_back(EventOf(row));
    event.epoch = epoch;
    event.number = latest + static_cast<int64_t>(events.size());
  }
  MORTISE_RETURN_IF_ERROR(
      connection_
          ->Run("INSERT INTO events (number, epoch, time, type, subject, payload, trace_id)"
                " SELECT CAST($1 AS BIGINT) + row_number() OVER (ORDER BY id), CAST($2 AS BIGINT), "
                "time, type, subject, payload,"
                " trace_id FROM outbox WHERE id <= $3 ORDER BY id",
                {latest, epoch, last_id})
          .status());
  MORTISE_RETURN_IF_ERROR(
      connection_->Run("DELETE FROM outbox WHERE id <= $1", {last_id}).status());
  MORTISE_RETURN_IF_ERROR(
      connection_->Run("UPDATE event_stream SET latest_number = $1", {events.back().number})
          .status());
  return events;
}

}  // namespace mortise::store
