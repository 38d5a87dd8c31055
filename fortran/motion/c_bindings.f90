!> Interfaces of c/quake, one for each function of c/include/extrados_quake.h that the core uses.
module motion_c_bindings
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: extrados_motion_phases, extrados_envelope, extrados_line_spectrum, extrados_line_widths
   public :: extrados_line_amplitudes, extrados_line_table, extrados_line_motion
   public :: extrados_fourier, extrados_fourier_inverse, extrados_oscillator_lanes

   interface
      function extrados_motion_phases(seed, index, count, phase) bind(c) result(status)
         import :: c_int, c_int64_t, c_double
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: seed, index
         integer(c_int), value, intent(in) :: count
         real(c_double), intent(out) :: phase(*)
         integer(c_int) :: status
      end function extrados_motion_phases

      function extrados_envelope(kind, parameter, points, step, value) bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: kind, points
         real(c_double), intent(in) :: parameter(4)
         real(c_double), value, intent(in) :: step
         real(c_double), intent(out) :: value(*)
         integer(c_int) :: status
      end function extrados_envelope

      function extrados_line_spectrum(intensities, intensity, frequencies, frequency, amplitude, wanted, &
                                      lines, line, value) bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: intensities, frequencies, lines
         real(c_double), intent(in) :: intensity(*), frequency(*), amplitude(*), line(*)
         real(c_double), value, intent(in) :: wanted
         real(c_double), intent(out) :: value(*)
         integer(c_int) :: status
      end function extrados_line_spectrum

      function extrados_line_widths(spacing, lines, line, width) bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: spacing, lines
         real(c_double), intent(in) :: line(*)
         real(c_double), intent(out) :: width(*)
         integer(c_int) :: status
      end function extrados_line_widths

      function extrados_line_amplitudes(scaling, factor, duration, lines, value, width, amplitude) &
         bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: scaling, lines
         real(c_double), value, intent(in) :: factor, duration
         real(c_double), intent(in) :: value(*), width(*)
         real(c_double), intent(out) :: amplitude(*)
         integer(c_int) :: status
      end function extrados_line_amplitudes

      function extrados_line_table(lines, line, points, step, envelope, table) bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: lines, points
         real(c_double), value, intent(in) :: step
         real(c_double), intent(in) :: line(*), envelope(*)
         real(c_double), intent(out) :: table(*)
         integer(c_int) :: status
      end function extrados_line_table

      function extrados_line_motion(seed, index, lines, amplitude, points, table, motion) bind(c) result(status)
         import :: c_int, c_int64_t, c_double
         implicit none (type, external)
         integer(c_int64_t), value, intent(in) :: seed, index
         integer(c_int), value, intent(in) :: lines, points
         real(c_double), intent(in) :: amplitude(*), table(*)
         real(c_double), intent(out) :: motion(*)
         integer(c_int) :: status
      end function extrados_line_motion

      function extrados_fourier(points, series, length, re, im) bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: points, length
         real(c_double), intent(in) :: series(*)
         real(c_double), intent(out) :: re(*), im(*)
         integer(c_int) :: status
      end function extrados_fourier

      function extrados_fourier_inverse(length, re, im, series) bind(c) result(status)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: length
         real(c_double), intent(in) :: re(*), im(*)
         real(c_double), intent(out) :: series(*)
         integer(c_int) :: status
      end function extrados_fourier_inverse

      subroutine extrados_oscillator_lanes(points, motion, parts, coefficients, state, most) bind(c)
         import :: c_int, c_double
         implicit none (type, external)
         integer(c_int), value, intent(in) :: points, parts
         real(c_double), intent(in) :: motion(*), coefficients(*)
         real(c_double), intent(inout) :: state(*), most(*)
      end subroutine extrados_oscillator_lanes
   end interface

end module motion_c_bindings
