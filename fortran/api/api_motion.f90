!> Generated earthquakes, response spectra, Fourier transforms, intensity measures.
module api_motion
   use, intrinsic :: iso_c_binding, only : c_double, c_int, c_int64_t
   implicit none
   private
   public :: envelope, line_spectrum, line_widths, line_amplitudes, generate, phases
   public :: spectra, oscillator, motion_measure, kinematics, fourier, fourier_inverse

contains

   !> Envelope of a generated motion at times 0, step, ...
   subroutine envelope(kind, parameter, points, step, value, status)
      use motion_c_bindings, only : extrados_envelope
      integer(c_int), intent(in) :: kind               !! as in extrados_quake.h
      real(c_double), intent(in) :: parameter(4)
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: step               !! [s]
      real(c_double), intent(out) :: value(points)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      value = 0.0_c_double
      status = extrados_envelope(kind, parameter, points, step, value)
   end subroutine envelope

   !> Fourier amplitude at given lines from a table over frequency and intensity
   subroutine line_spectrum(nm, intensity, nf, frequency, amplitude, wanted, nl, line, value, status)
      use motion_c_bindings, only : extrados_line_spectrum
      integer(c_int), intent(in) :: nm
      real(c_double), intent(in) :: intensity(nm)
      integer(c_int), intent(in) :: nf
      real(c_double), intent(in) :: frequency(nf)      !! [Hz]
      real(c_double), intent(in) :: amplitude(nf, nm)  !! [m/s]
      real(c_double), intent(in) :: wanted             !! intensity
      integer(c_int), intent(in) :: nl
      real(c_double), intent(in) :: line(nl)           !! [Hz]
      real(c_double), intent(out) :: value(nl)         !! [m/s]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      value = 0.0_c_double
      status = extrados_line_spectrum(nm, intensity, nf, frequency, amplitude, wanted, nl, line, value)
   end subroutine line_spectrum

   !> Share of the band for which each line stands
   subroutine line_widths(spacing, n, line, width, status)
      use motion_c_bindings, only : extrados_line_widths
      integer(c_int), intent(in) :: spacing            !! 1 log, 2 uniform
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: line(n)            !! [Hz]
      real(c_double), intent(out) :: width(n)          !! [Hz]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      width = 0.0_c_double
      status = extrados_line_widths(spacing, n, line, width)
   end subroutine line_widths

   !> Amplitudes of the sine lines
   subroutine line_amplitudes(scaling, factor, duration, n, value, width, amplitude, status)
      use motion_c_bindings, only : extrados_line_amplitudes
      integer(c_int), intent(in) :: scaling            !! 1 thesis, 2 fourier, 3 energy
      real(c_double), intent(in) :: factor
      real(c_double), intent(in) :: duration           !! integral of the squared envelope [s]
      integer(c_int), intent(in) :: n
      real(c_double), intent(in) :: value(n)           !! [m/s]
      real(c_double), intent(in) :: width(n)           !! [Hz]
      real(c_double), intent(out) :: amplitude(n)      !! [m/s^2]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      amplitude = 0.0_c_double
      status = extrados_line_amplitudes(scaling, factor, duration, n, value, width, amplitude)
   end subroutine line_amplitudes

   !> Random phases of one motion of a set
   subroutine phases(seed, position, n, phase, status)
      use motion_c_bindings, only : extrados_motion_phases
      integer(c_int64_t), intent(in) :: seed
      integer(c_int64_t), intent(in) :: position       !! of the motion, 0-based
      integer(c_int), intent(in) :: n
      real(c_double), intent(out) :: phase(n)          !! [rad]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      phase = 0.0_c_double
      status = extrados_motion_phases(seed, position, n, phase)
   end subroutine phases

   !> Motions first .. first + count - 1 of a set
   subroutine generate(nl, line, amplitude, points, step, window, seed, first, count, threads, motions, status)
      use common_threads, only : threads_available
      use motion_generator, only : make => generate_motions
      integer(c_int), intent(in) :: nl
      real(c_double), intent(in) :: line(nl)           !! [Hz]
      real(c_double), intent(in) :: amplitude(nl)      !! [m/s^2]
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: step               !! [s]
      real(c_double), intent(in) :: window(points)     !! envelope
      integer(c_int64_t), intent(in) :: seed
      integer(c_int64_t), intent(in) :: first          !! 0-based
      integer(c_int), intent(in) :: count
      integer(c_int), intent(in) :: threads
      real(c_double), intent(out) :: motions(points, count)  !! [m/s^2]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call make(line, amplitude, step, window, seed, first, threads_available(threads), motions, status)
   end subroutine generate

   !> Peak displacement, velocity and absolute acceleration of every oscillator for every motion
   subroutine spectra(points, count, motions, step, np, period, nd, damping, points_per_cycle, threads, &
                      peak, status)
      use common_threads, only : threads_available
      use motion_oscillator, only : response_spectra
      integer(c_int), intent(in) :: points
      integer(c_int), intent(in) :: count
      real(c_double), intent(in) :: motions(points, count)   !! [m/s^2]
      real(c_double), intent(in) :: step                     !! [s]
      integer(c_int), intent(in) :: np
      real(c_double), intent(in) :: period(np)               !! [s]
      integer(c_int), intent(in) :: nd
      real(c_double), intent(in) :: damping(nd)
      integer(c_int), intent(in) :: points_per_cycle
      integer(c_int), intent(in) :: threads
      real(c_double), intent(out) :: peak(3, np, nd, count)  !! [m, m/s, m/s^2]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call response_spectra(motions, step, period, damping, points_per_cycle, threads_available(threads), peak, status)
   end subroutine spectra

   !> History of one oscillator at the samples
   subroutine oscillator(points, motion, step, period, damping, points_per_cycle, u, v, status)
      use motion_oscillator, only : oscillator_history
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: motion(points)     !! [m/s^2]
      real(c_double), intent(in) :: step               !! [s]
      real(c_double), intent(in) :: period             !! [s]
      real(c_double), intent(in) :: damping
      integer(c_int), intent(in) :: points_per_cycle
      real(c_double), intent(out) :: u(points)         !! [m]
      real(c_double), intent(out) :: v(points)         !! [m/s]
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call oscillator_history(motion, step, period, damping, points_per_cycle, u, v, status)
   end subroutine oscillator

   !> Intensity measures, in the order of motion_measures
   subroutine motion_measure(points, count, motions, step, threads, value, status)
      use common_threads, only : threads_available
      use motion_measures, only : measure_motions
      integer(c_int), intent(in) :: points
      integer(c_int), intent(in) :: count
      real(c_double), intent(in) :: motions(points, count)   !! [m/s^2]
      real(c_double), intent(in) :: step                     !! [s]
      integer(c_int), intent(in) :: threads
      real(c_double), intent(out) :: value(9, count)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      call measure_motions(motions, step, threads_available(threads), value, status)
   end subroutine motion_measure

   !> Velocity and displacement from rest
   subroutine kinematics(points, motion, step, v, d)
      use motion_measures, only : integrate_motion
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: motion(points)     !! [m/s^2]
      real(c_double), intent(in) :: step               !! [s]
      real(c_double), intent(out) :: v(points)         !! [m/s]
      real(c_double), intent(out) :: d(points)         !! [m]
      !f2py threadsafe
      v = 0.0_c_double
      d = 0.0_c_double
      if (points > 0) call integrate_motion(motion, step, v, d)
   end subroutine kinematics

   !> Fourier transform of a series padded with zeros
   subroutine fourier(points, series, length, half, re, im, status)
      use motion_c_bindings, only : extrados_fourier
      use common_status, only : status_invalid_argument
      integer(c_int), intent(in) :: points
      real(c_double), intent(in) :: series(points)
      integer(c_int), intent(in) :: length
      integer(c_int), intent(in) :: half               !! length / 2 + 1
      real(c_double), intent(out) :: re(half)
      real(c_double), intent(out) :: im(half)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      re = 0.0_c_double
      im = 0.0_c_double
      status = status_invalid_argument
      if (half == length / 2 + 1) status = extrados_fourier(points, series, length, re, im)
   end subroutine fourier

   !> Its inverse
   subroutine fourier_inverse(half, re, im, length, series, status)
      use motion_c_bindings, only : extrados_fourier_inverse
      use common_status, only : status_invalid_argument
      integer(c_int), intent(in) :: half               !! length / 2 + 1
      real(c_double), intent(in) :: re(half)
      real(c_double), intent(in) :: im(half)
      integer(c_int), intent(in) :: length
      real(c_double), intent(out) :: series(length)
      integer(c_int), intent(out) :: status
      !f2py threadsafe
      series = 0.0_c_double
      status = status_invalid_argument
      if (half == length / 2 + 1) status = extrados_fourier_inverse(length, re, im, series)
   end subroutine fourier_inverse

end module api_motion
