!> Two functions of time with common break points: the horizontal and the vertical ground
!> acceleration. Between breaks each is smooth, so an integrator that stops at every break
!> keeps its order. Before the first and after the last break both are zero.
module common_signal
   use common_kinds, only : wp, pi
   implicit none
   private
   public :: signal, signal_sampled, signal_piecewise

   type :: signal
      integer :: segments = 0                            !! intervals between breaks
      real(wp), pointer, contiguous :: breaks(:) => null()      !! (segments+1) [s], piecewise form only
      !> Sampled form: (channels, segments+1) values joined by straight lines
      real(wp), pointer, contiguous :: samples(:, :) => null()
      real(wp) :: start = 0.0_wp                         !! time of the first sample [s]
      real(wp) :: step = 0.0_wp                          !! sampling step [s]
      !> Piecewise form: (2, channels, segments), value and slope at the segment's start
      real(wp), pointer, contiguous :: linear(:, :, :) => null()
      !> (4, terms, channels, segments): amplitude, its growth per second, angular frequency
      !> [rad/s] and phase of (a + b tau) sin(w tau + phi), tau from the segment's start
      real(wp), pointer, contiguous :: harmonic(:, :, :, :) => null()
      real(wp) :: scale = 1.0_wp                         !! factor on every value
   contains
      procedure :: break_time
      procedure :: value_at
      procedure :: line_at
      procedure :: smooth_to_next
      procedure :: shortest_period
      procedure :: has_harmonics
   end type signal

contains

   !> Samples at equal steps, joined by straight lines
   function signal_sampled(start, step, samples, scale) result(s)
      real(wp), intent(in) :: start                          !! time of the first sample [s]
      real(wp), intent(in) :: step                           !! sampling step [s]
      real(wp), intent(in), target, contiguous :: samples(:, :)  !! (channels, points)
      real(wp), intent(in) :: scale                          !! factor on every value
      type(signal) :: s
      s%segments = size(samples, 2) - 1
      s%start = start
      s%step = step
      s%samples => samples
      s%scale = scale
   end function signal_sampled

   !> Straight lines and sines on each segment
   function signal_piecewise(breaks, linear, harmonic, scale) result(s)
      real(wp), intent(in), target, contiguous :: breaks(:)             !! (segments+1) [s]
      real(wp), intent(in), target, contiguous :: linear(:, :, :)       !! (2, channels, segments)
      real(wp), intent(in), target, contiguous :: harmonic(:, :, :, :)  !! (4, terms, channels, segments)
      real(wp), intent(in) :: scale                                     !! factor on every value
      type(signal) :: s
      s%segments = size(linear, 3)
      s%breaks => breaks
      s%linear => linear
      s%harmonic => harmonic
      s%scale = scale
      s%start = breaks(1)
   end function signal_piecewise

   !> Start time of segment k (1-based); k = segments + 1 gives the end of the signal
   pure function break_time(motion, k) result(t)
      class(signal), intent(in) :: motion
      integer, intent(in) :: k
      real(wp) :: t
      if (associated(motion%samples)) then
         t = motion%start + real(k - 1, wp) * motion%step
      else
         t = motion%breaks(k)
      end if
   end function break_time

   !> Horizontal and vertical value in segment k; k outside 1..segments is the quiet time around
   pure subroutine value_at(motion, k, t, horizontal, vertical)
      class(signal), intent(in) :: motion
      integer, intent(in) :: k               !! segment
      real(wp), intent(in) :: t              !! time [s]
      real(wp), intent(out) :: horizontal
      real(wp), intent(out) :: vertical
      real(wp) :: tau, value(2)
      integer :: c, i, channels

      horizontal = 0.0_wp
      vertical = 0.0_wp
      if (k < 1 .or. k > motion%segments) return
      value = 0.0_wp
      if (associated(motion%samples)) then
         tau = (t - motion%start) / motion%step - real(k - 1, wp)
         do c = 1, size(motion%samples, 1)
            value(c) = motion%samples(c, k) + tau * (motion%samples(c, k + 1) - motion%samples(c, k))
         end do
      else
         tau = t - motion%breaks(k)
         channels = size(motion%linear, 2)
         do c = 1, channels
            value(c) = motion%linear(1, c, k) + tau * motion%linear(2, c, k)
            do i = 1, size(motion%harmonic, 2)
               associate (h => motion%harmonic(:, i, c, k))
                  value(c) = value(c) + (h(1) + tau * h(2)) * sin(h(3) * tau + h(4))
               end associate
            end do
         end do
      end if
      horizontal = motion%scale * value(1)
      vertical = motion%scale * value(2)
   end subroutine value_at

   !> Value at time t and slope of the straight lines of segment k, without the sines
   pure subroutine line_at(motion, k, t, value, slope)
      class(signal), intent(in) :: motion
      integer, intent(in) :: k           !! segment
      real(wp), intent(in) :: t          !! time [s]
      real(wp), intent(out) :: value(2)  !! horizontal and vertical
      real(wp), intent(out) :: slope(2)  !! their change per second
      real(wp) :: tau
      integer :: c

      value = 0.0_wp
      slope = 0.0_wp
      if (k < 1 .or. k > motion%segments) return
      if (associated(motion%samples)) then
         tau = t - (motion%start + real(k - 1, wp) * motion%step)
         do c = 1, size(motion%samples, 1)
            slope(c) = motion%scale * (motion%samples(c, k + 1) - motion%samples(c, k)) / motion%step
            value(c) = motion%scale * motion%samples(c, k) + tau * slope(c)
         end do
      else
         tau = t - motion%breaks(k)
         do c = 1, size(motion%linear, 2)
            slope(c) = motion%scale * motion%linear(2, c, k)
            value(c) = motion%scale * motion%linear(1, c, k) + tau * slope(c)
         end do
      end if
   end subroutine line_at

   !> True where the signal is continuous from segment k into k + 1: samples joined by lines are
   pure function smooth_to_next(motion, k) result(answer)
      class(signal), intent(in) :: motion
      integer, intent(in) :: k
      logical :: answer
      answer = associated(motion%samples) .and. k >= 1 .and. k < motion%segments
   end function smooth_to_next

   !> Shortest period of the sines in segment k [s]; huge where it is straight
   pure function shortest_period(motion, k) result(period)
      class(signal), intent(in) :: motion
      integer, intent(in) :: k
      real(wp) :: period
      real(wp) :: fastest
      period = huge(period)
      if (.not. associated(motion%harmonic) .or. k < 1 .or. k > motion%segments) return
      if (size(motion%harmonic, 2) == 0) return
      fastest = maxval(abs(motion%harmonic(3, :, :, k)))
      if (fastest > 0.0_wp) period = 2.0_wp * pi / fastest
   end function shortest_period

   !> True where some segment may curve
   pure function has_harmonics(motion) result(answer)
      class(signal), intent(in) :: motion
      logical :: answer
      answer = .false.
      if (associated(motion%harmonic)) answer = size(motion%harmonic, 2) > 0
   end function has_harmonics

end module common_signal
