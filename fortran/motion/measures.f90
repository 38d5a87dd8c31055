!> Intensity measures of sampled accelerations. Velocity, displacement and CAV are exact for samples joined by
!> straight lines. The Arias intensity takes the trapezoid rule on the squares: by Parseval's theorem it keeps the
!> energy of the lines, of which straight lines between samples would lose a tenth at 13 Hz and 0.01 s.
module motion_measures
   use, intrinsic :: iso_c_binding, only : c_int
   use common_cancel, only : cancel_requested
   use common_kinds, only : wp, pi, gravity
   use common_status, only : status_ok, status_cancelled, status_invalid_argument, status_out_of_memory
   implicit none
   private
   public :: measure_motions, integrate_motion, measure_count

   !> pga [m/s^2], its time [s], pgv [m/s], pgd [m], Arias intensity [m/s], CAV [m/s],
   !> times of 5, 75 and 95 % of the Arias intensity [s]
   integer, parameter :: measure_count = 9

contains

   !> Velocity and displacement at the samples, from rest
   pure subroutine integrate_motion(a, step, v, d)
      real(wp), intent(in), contiguous :: a(:)     !! [m/s^2]
      real(wp), intent(in) :: step                 !! [s]
      real(wp), intent(out), contiguous :: v(:)    !! [m/s]
      real(wp), intent(out), contiguous :: d(:)    !! [m]
      integer :: i
      v(1) = 0.0_wp
      d(1) = 0.0_wp
      do i = 2, size(a)
         v(i) = v(i - 1) + 0.5_wp * step * (a(i - 1) + a(i))
         d(i) = d(i - 1) + step * v(i - 1) + step**2 * (2.0_wp * a(i - 1) + a(i)) / 6.0_wp
      end do
   end subroutine integrate_motion

   !> Measures of many motions
   subroutine measure_motions(motions, step, threads, value, status)
      real(wp), intent(in), contiguous :: motions(:, :)   !! (points, count) [m/s^2]
      real(wp), intent(in) :: step                        !! [s]
      integer(c_int), intent(in) :: threads
      real(wp), intent(out), contiguous :: value(:, :)    !! (measure_count, count)
      integer(c_int), intent(out) :: status
      integer(c_int), allocatable :: fate(:)
      integer :: k, stat

      value = 0.0_wp
      status = status_invalid_argument
      if (threads < 1 .or. .not. step > 0.0_wp .or. size(motions, 1) < 1) return
      status = status_out_of_memory
      allocate (fate(size(motions, 2)), stat=stat)
      if (stat /= 0) return
      fate = status_cancelled
      !$omp parallel do schedule(static) default(none) num_threads(threads) private(k) &
      !$omp shared(motions, step, value, fate)
      do k = 1, size(motions, 2)
         if (cancel_requested()) cycle
         call measure_motion(motions(:, k), step, value(:, k))
         fate(k) = status_ok
      end do
      !$omp end parallel do
      status = status_ok
      if (size(fate) > 0) status = maxval(fate)
   end subroutine measure_motions

   !> Measures of one motion
   pure subroutine measure_motion(a, step, value)
      real(wp), intent(in), contiguous :: a(:)
      real(wp), intent(in) :: step
      real(wp), intent(out) :: value(measure_count)
      real(wp) :: v, d, v_new, pgv, pgd, square, cav, below, share, part
      real(wp), parameter :: level(3) = [0.05_wp, 0.75_wp, 0.95_wp]
      integer :: i, top, next

      top = maxloc(abs(a), dim=1)
      v = 0.0_wp
      d = 0.0_wp
      pgv = 0.0_wp
      pgd = 0.0_wp
      square = 0.0_wp
      cav = 0.0_wp
      do i = 2, size(a)
         associate (p => a(i - 1), q => a(i))
            v_new = v + 0.5_wp * step * (p + q)
            d = d + step * v + step**2 * (2.0_wp * p + q) / 6.0_wp
            if (p * q < 0.0_wp) then
               ! velocity turns where the acceleration crosses zero
               pgv = max(pgv, abs(v + 0.5_wp * step * p * p / (p - q)))
               cav = cav + 0.5_wp * step * (p**2 + q**2) / (abs(p) + abs(q))
            else
               cav = cav + 0.5_wp * step * abs(p + q)
            end if
            v = v_new
            pgv = max(pgv, abs(v))
            pgd = max(pgd, abs(d))
            square = square + 0.5_wp * step * (p**2 + q**2)
         end associate
      end do
      value(1:6) = [abs(a(top)), real(top - 1, wp) * step, pgv, pgd, 0.5_wp * pi / gravity * square, cav]
      value(7:9) = 0.0_wp
      below = 0.0_wp
      next = 1
      do i = 2, size(a)
         part = 0.5_wp * step * (a(i - 1)**2 + a(i)**2)
         do while (next <= 3)
            if (below + part < level(next) * square .or. .not. part > 0.0_wp) exit
            share = (level(next) * square - below) / part
            value(6 + next) = (real(i - 2, wp) + share) * step
            next = next + 1
         end do
         below = below + part
      end do
      ! rounding may keep the last sum just below its level
      do while (next <= 3 .and. square > 0.0_wp)
         value(6 + next) = real(size(a) - 1, wp) * step
         next = next + 1
      end do
   end subroutine measure_motion

end module motion_measures
