!> Loading of a model: the ground, and supports that move.
module dem_loading
   use common_kinds, only : wp, pi
   use common_signal, only : signal
   use common_status, only : status_ok, status_bad_index, status_invalid_argument, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: loading, support_move, accept_moves, mean_acceleration, move_rate, movement_end

   !> A support moves by (dx, dy, turn), in space by (dx, dy, dz), between two times, starting and ending at rest
   type :: support_move
      integer :: body = 0
      real(wp) :: shift(3) = 0.0_wp        !! [m, m, rad], in space [m]
      real(wp) :: start = 0.0_wp           !! [s]
      real(wp) :: duration = 1.0_wp        !! [s]
   end type support_move

   type :: loading
      type(signal) :: ground               !! acceleration [m/s^2]
      type(signal) :: across               !! its other horizontal component, of blocks in space [m/s^2]
      logical :: moving_base = .false.     !! supports move; otherwise a body force in the ground's frame
      type(support_move), allocatable :: move(:)
   end type loading

contains

   !> Take over movements of supports: bodies that are `fixed`
   subroutine accept_moves(load, body, value, fixed, status)
      type(loading), intent(inout) :: load
      integer(c_int), intent(in) :: body(:)   !! (moves), 1-based
      real(wp), intent(in) :: value(:, :)     !! (5, moves) shift, see support_move; start, duration [s]
      logical, intent(in) :: fixed(:)         !! (bodies)
      integer(c_int), intent(out) :: status
      type(support_move), allocatable :: move(:)
      integer :: k, failed
      status = status_bad_index
      if (any(body < 1) .or. any(body > size(fixed))) return
      if (.not. all(fixed(body))) return
      status = status_invalid_argument
      if (.not. all(value(5, :) > 0.0_wp)) return
      status = status_out_of_memory
      allocate (move(size(body)), stat=failed)
      if (failed /= 0) return
      do k = 1, size(body)
         move(k) = support_move(int(body(k)), value(1:3, k), value(4, k), value(5, k))
      end do
      call move_alloc(move, load%move)
      status = status_ok
   end subroutine accept_moves

   !> Mean ground acceleration between two times: exact across jumps, so that a pulse gives its velocity
   pure subroutine mean_acceleration(ground, segment, t0, t1, mean)
      type(signal), intent(in) :: ground
      integer, intent(inout) :: segment       !! where the last call ended; 0 at first
      real(wp), intent(in) :: t0              !! [s]
      real(wp), intent(in) :: t1              !! [s]
      real(wp), intent(out) :: mean(2)        !! horizontal, vertical [m/s^2]
      real(wp) :: from, to, h, v
      integer :: k

      mean = 0.0_wp
      do while (segment <= ground%segments)
         if (ground%break_time(segment + 1) > t0) exit
         segment = segment + 1
      end do
      if (.not. t1 > t0) return
      k = segment
      from = t0
      do while (k <= ground%segments)
         to = min(t1, ground%break_time(k + 1))
         if (to > from) then
            call ground%value_at(k, 0.5_wp * (from + to), h, v)
            mean = mean + (to - from) * [h, v]
            from = to
         end if
         if (.not. from < t1) exit
         k = k + 1
      end do
      mean = mean / (t1 - t0)
   end subroutine mean_acceleration

   !> Velocity of a support that moves, along a raised cosine
   pure function move_rate(move, t) result(rate)
      type(support_move), intent(in) :: move
      real(wp), intent(in) :: t               !! [s]
      real(wp) :: rate(3)
      real(wp) :: phase
      rate = 0.0_wp
      phase = (t - move%start) / move%duration
      if (phase > 0.0_wp .and. phase < 1.0_wp) then
        rate = move%shift / move%duration * (1.0_wp - cos(2.0_wp * pi * phase))
      end if
   end function move_rate

   !> When ground and supports have come to rest [s]
   pure function movement_end(load) result(t)
      type(loading), intent(in) :: load
      real(wp) :: t
      integer :: k
      t = 0.0_wp
      if (load%ground%segments > 0) t = load%ground%break_time(load%ground%segments + 1)
      if (load%across%segments > 0) t = max(t, load%across%break_time(load%across%segments + 1))
      if (.not. allocated(load%move)) return
      do k = 1, size(load%move)
         t = max(t, load%move(k)%start + load%move(k)%duration)
      end do
   end function movement_end

end module dem_loading
