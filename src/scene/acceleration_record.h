// Acceleration records from files.
//
//   NAME.csv  header "time_s,acceleration_m_per_s2" or "time_s,acceleration_g", then one row a time, in increasing order; lines that begin with # and
//             empty lines are skipped
//   NAME.AT2  as the PEER strong motion database writes them: three lines of text, of which one names the unit ("UNITS OF G"), a line with the number
//             of values and the time between them ("NPTS=  4000, DT=  .0050 SEC", or the older "4000  0.0050  NPTS, DT"), then the values, the first
//             one at time 0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace openclose {

/// [m/s2] The g of records is the standard acceleration of free fall.
inline constexpr double standard_gravity = 9.80665;

/// Linear between its times, zero before the first and after the last of them. Two equal times make a jump.
struct AccelerationRecord {
  std::vector<double> times;          ///< [s] that do not decrease
  std::vector<double> accelerations;  ///< [m/s2] as many

  bool operator==(const AccelerationRecord&) const = default;
};

/// Which of the two it is follows from the ending of the name, in capitals or not. Throws InputError with file and line.
AccelerationRecord read_acceleration_record(const std::string& path);
/// The same for text that has been opened.
/// \param path  by which the kind is known and errors name the file
AccelerationRecord acceleration_record_in(std::istream& stream, const std::string& path);

}  // namespace openclose
