!> Where a model stands in time, and how its leap-frog steps follow one another: velocities at half steps, places and
!> forces at whole ones. What blocks of the plane and of space have in common.
module dem_clock
   use common_kinds, only : wp
   use dem_loading, only : loading, mean_acceleration
   implicit none
   private
   public :: model_clock, begin_step, end_step

   type :: model_clock
      type(loading) :: load                    !! what moves the model
      real(wp) :: t = 0.0_wp                   !! time of the next forces [s]
      real(wp) :: step = 0.0_wp                !! [s]
      real(wp) :: drift = 0.0_wp               !! position step that led here; 0 at the start [s]
      real(wp) :: kick = 0.0_wp                !! velocity step taken last [s]
      integer :: segment = 0                   !! of the ground motion
      integer :: segment_across = 0            !! and of its other horizontal component
      integer :: steps = 0
      integer :: waits = 0                     !! steps in a row in which time stands still, until all has come to rest
      logical :: quasi_static = .false.        !! without inertia: every step starts from rest
      logical :: shaking = .false.             !! false while settling: the ground rests
      logical :: stale = .false.               !! somebody moved far enough to look for contacts again
   end type model_clock

contains

   !> Length of the coming velocity step, and the ground acceleration over it
   pure subroutine begin_step(clock, ground)
      type(model_clock), intent(inout) :: clock
      real(wp), intent(out) :: ground(3)       !! mean, horizontal, vertical and across; 0 while settling [m/s^2]
      real(wp) :: half, from, to, other(2)
      ! At the very start half a velocity step leads from the initial velocity to the half step.
      half = 0.5_wp * clock%step
      clock%kick = 0.5_wp * clock%drift + half
      ground = 0.0_wp
      if (.not. clock%shaking) return
      from = clock%t - 0.5_wp * clock%drift
      to = clock%t + half
      call mean_acceleration(clock%load%ground, clock%segment, from, to, ground(1:2))
      if (clock%load%across%segments == 0) return
      call mean_acceleration(clock%load%across, clock%segment_across, from, to, other)
      ground(3) = other(1)
   end subroutine begin_step

   pure subroutine end_step(clock)
      type(model_clock), intent(inout) :: clock
      clock%drift = clock%step
      if (clock%waits == 0) clock%t = clock%t + clock%step
      clock%steps = clock%steps + 1
   end subroutine end_step

end module dem_clock
