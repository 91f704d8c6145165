#include "services/fabplanner/paper/qr_code.h"

#include <qrencode.h>

#include <cerrno>
#include <memory>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/freed_by.h"

namespace mortise::fabplanner {

absl::StatusOr<ModuleSquare> QrCodeOf(const std::string& text) {
  constexpr std::size_t kMostBytes = 2331;  // of version 40 at level M
  if (text.empty()) return InvalidField("code", "has no text");
  if (text.size() > kMostBytes) {
    return InvalidField(
        "code", absl::StrCat("has a text of ", text.size(), " bytes, more than the ", kMostBytes,
                             " that a QR code holds"));
  }
  const std::unique_ptr<QRcode, FreedBy<QRcode_free>> code(
      QRcode_encodeData(static_cast<int>(text.size()),
                        reinterpret_cast<const unsigned char*>(text.data()), 0, QR_ECLEVEL_M));
  if (code == nullptr) {
    return absl::InternalError(absl::StrCat("a QR code cannot be made (errno ", errno, ")"));
  }
  ModuleSquare square;
  square.side = code->width;
  const int count = code->width * code->width;
  for (int i = 0; i < count; ++i) square.dark.push_back((code->data[i] & 1) != 0);
  return square;
}

}  // namespace mortise::fabplanner
