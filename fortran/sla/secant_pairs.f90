!> Pairs of a change of displacements and the change of forces that came with it: the limited-memory BFGS approximation of
!> a stiffness (Nocedal 1980; Nocedal and Wright 2006, algorithm 7.4), on any symmetric matrix as its start.
!>
!> The direction -H g for the inverse stiffness H comes in two passes around the solution with that matrix: `reduce` takes
!> from the forces g what the pairs explain, `complete` adds the displacements of the pairs. The multiplier of the
!> reference load changes with the displacements.
module sla_secant_pairs
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: pair_memory

   integer, parameter :: most_pairs = 8
   !> Least work of a pair over that of the forces along the way: else the stiffness along it is negative, or nearly zero
   real(wp), parameter :: least_work = 1.0e-3_wp

   type :: pair_memory
      integer :: count = 0                             !! pairs taken so far, of which the last ones are kept
      real(wp), allocatable :: moved(:, :)             !! (equations, most_pairs) [m]
      real(wp), allocatable :: force(:, :)             !! (equations, most_pairs) [N]
      real(wp) :: lambda(most_pairs) = 0.0_wp
      real(wp) :: work(most_pairs) = 0.0_wp            !! moved.force [J]
      real(wp) :: part(most_pairs) = 0.0_wp            !! of each pair in the forces reduced last
   contains
      procedure :: make
      procedure :: take
      procedure :: reduce
      procedure :: complete
      procedure, private :: first
   end type pair_memory

contains

   subroutine make(pairs, equations, status)
      class(pair_memory), intent(out) :: pairs
      integer, intent(in) :: equations
      integer(c_int), intent(out) :: status
      integer :: info
      allocate (pairs%moved(equations, most_pairs), pairs%force(equations, most_pairs), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
   end subroutine make

   !> The oldest pair kept
   pure function first(pairs) result(i)
      class(pair_memory), intent(in) :: pairs
      integer :: i
      i = max(1, pairs%count - most_pairs + 1)
   end function first

   !> One more pair, if the stiffness along it is positive
   pure subroutine take(pairs, moved, lambda, force, work)
      class(pair_memory), intent(inout) :: pairs
      real(wp), intent(in) :: moved(:)         !! [m]
      real(wp), intent(in) :: lambda           !! change of the multiplier
      real(wp), intent(in) :: force(:)         !! change of forces [N]
      real(wp), intent(in) :: work             !! of the forces before, along the way [J]
      integer :: at
      if (.not. dot_product(moved, force) > least_work * abs(work)) return
      at = 1 + modulo(pairs%count, most_pairs)
      pairs%moved(:, at) = moved
      pairs%force(:, at) = force
      pairs%lambda(at) = lambda
      pairs%work(at) = dot_product(moved, force)
      pairs%count = pairs%count + 1
   end subroutine take

   !> Forces without what the pairs explain
   pure subroutine reduce(pairs, force)
      class(pair_memory), intent(inout) :: pairs
      real(wp), intent(inout) :: force(:)      !! [N]
      integer :: i, at
      do i = pairs%count, pairs%first(), -1
         at = 1 + modulo(i - 1, most_pairs)
         pairs%part(at) = dot_product(pairs%moved(:, at), force) / pairs%work(at)
         force = force - pairs%part(at) * pairs%force(:, at)
      end do
   end subroutine reduce

   !> The direction of the reduced forces with the displacements of the pairs
   pure subroutine complete(pairs, z, lambda)
      class(pair_memory), intent(in) :: pairs
      real(wp), intent(inout) :: z(:)          !! [m]
      real(wp), intent(inout) :: lambda
      real(wp) :: part
      integer :: i, at
      do i = pairs%first(), pairs%count
         at = 1 + modulo(i - 1, most_pairs)
         part = pairs%part(at) + dot_product(pairs%force(:, at), z) / pairs%work(at)
         z = z - part * pairs%moved(:, at)
         lambda = lambda - part * pairs%lambda(at)
      end do
   end subroutine complete

end module sla_secant_pairs
