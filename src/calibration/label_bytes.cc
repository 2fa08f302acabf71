#include "src/calibration/label_bytes.h"

#include "src/common/bytes.h"

namespace alidade::internal {

void PutLabel(const ObservationLabel& label, ByteWriter* writer) {
  writer->PutText(label.kind);
  writer->Put(label.pose);
  writer->PutText(label.target);
  writer->PutText(label.where);
  writer->Put(label.has_length);
  writer->Put(label.has_rotation);
}

ObservationLabel GetLabel(ByteReader* reader) {
  ObservationLabel label;
  label.kind = reader->GetText();
  label.pose = reader->Get<int>();
  label.target = reader->GetText();
  label.where = reader->GetText();
  label.has_length = reader->Get<bool>();
  label.has_rotation = reader->Get<bool>();
  return label;
}

}  // namespace alidade::internal
