// The states of a result for ParaView and everything else that reads VTK's XML files.
//
// In the folder vtk: blocks_0000_start.vtu, ... with a polygon a block, contacts_0000_start.vtu, ... with a point a contact, and blocks.pvd,
// contacts.pvd, which name them in the order of time. Arrays are base64 (inline binary, little-endian, header UInt64), so that no digit is lost.
// Units stand in the names.
#pragma once

#include <string>

#include "openclose/io/output_folder.h"

namespace openclose {

/// Writes them from the tables of the folder. Of a run the times are those of the states; states of a factor of safety are numbered from 0. The
/// drawing
/// ("initial") is left out, as is a state at the time of the one before. Throws WriteError if a file cannot be written to its end.
void write_vtk(const OutputFolder& folder);

/// Base64 of bytes, with padding (RFC 4648).
std::string base64(const char* bytes, std::size_t size);

}  // namespace openclose
