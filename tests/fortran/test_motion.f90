!> Response spectra against closed forms; generated motions against any split of the set.
program test_motion
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   use common_kinds, only : wp, pi
   use common_status, only : status_ok, status_invalid_argument
   use motion_generator, only : generate_motions
   use motion_measures, only : measure_motions, measure_count
   use motion_oscillator, only : oscillator_history, response_spectra
   implicit none (type, external)
   integer, parameter :: n = 801
   real(wp), parameter :: step = 0.005_wp, period = 0.7_wp, damping = 0.05_wp
   real(wp) :: a(n), u(n), v(n), exact(n), w, wd, t, peak(3, 2, 2, 1), value(measure_count, 1)
   real(wp) :: whole(50, 6), part(50, 2), line(3), window(50)
   integer(c_int) :: status
   integer :: i

   ! constant acceleration: u = -(a/w^2) [1 - exp(-z w t) (cos wd t + z w/wd sin wd t)]
   w = 2.0_wp * pi / period
   wd = w * sqrt(1.0_wp - damping**2)
   a = 2.0_wp
   do i = 1, n
      t = real(i - 1, wp) * step
      exact(i) = -2.0_wp / w**2 * (1.0_wp - exp(-damping * w * t) * (cos(wd * t) + damping * w / wd * sin(wd * t)))
   end do
   call oscillator_history(a, step, period, damping, 20_c_int, u, v, status)
   if (status /= status_ok .or. maxval(abs(u - exact)) > 1e-13_wp) error stop 'the oscillator is not exact'

   call response_spectra(reshape(a, [n, 1]), step, [period, 0.03_wp], [damping, 0.0_wp], 20_c_int, 2_c_int, &
      peak, status)
   if (status /= status_ok) error stop 'no spectrum'
   if (abs(peak(1, 1, 1, 1) - maxval(abs(exact))) > 1e-13_wp) error stop 'the spectrum is not the peak of the history'
   if (abs(peak(1, 2, 2, 1) * (2.0_wp * pi / 0.03_wp)**2 - 4.0_wp) > 0.05_wp) error stop 'a step load does not double'
   call response_spectra(reshape(a, [n, 1]), step, [1e-9_wp, 1.0_wp], [damping, 0.0_wp], 20_c_int, 1_c_int, &
      peak, status)
   if (status /= status_invalid_argument) error stop 'a period too short for the sampling is taken'

   call measure_motions(reshape(a, [n, 1]), step, 1_c_int, value, status)
   if (abs(value(3, 1) - 8.0_wp) > 1e-12_wp .or. abs(value(6, 1) - 8.0_wp) > 1e-12_wp) error stop 'PGV or CAV'

   line = [1.0_wp, 2.0_wp, 5.0_wp]
   window = 1.0_wp
   call generate_motions(line, line, step, window, 7_c_int64_t, 0_c_int64_t, 2_c_int, whole, status)
   if (status /= status_ok) error stop 'no motions'
   call generate_motions(line, line, step, window, 7_c_int64_t, 3_c_int64_t, 1_c_int, part, status)
   if (any(abs(part - whole(:, 4:5)) > 0.0_wp)) error stop 'a motion depends on its batch'
   print '(a)', 'motion: all right'
end program test_motion
