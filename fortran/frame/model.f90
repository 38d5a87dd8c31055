!> A frame of macro-elements and links between rigid nodes: its forces and tangent, and its equilibrium.
module frame_model
   use common_kinds, only : wp
   use common_status, only : status_ok, status_singular, status_too_many_steps
   use frame_element, only : macro_element, element_state, element_forces, element_committed, element_failed
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: frame, frame_link, frame_state, frame_state_new, take_over, assemble, equilibrate, commit, solve

   !> An elastic, perfectly plastic link: its deformation is a sum of displacements of a few freedoms. One that returns has no
   !> plastic deformation: beyond its strength it carries a weight that is lifted and set down again.
   type :: frame_link
      integer(c_int) :: freedom(8) = 0            !! 0 is held
      real(wp) :: part(8) = 0.0_wp
      real(wp) :: stiffness = 0.0_wp              !! [N/m]
      real(wp) :: strength(2) = 0.0_wp            !! against negative and positive deformation, both not negative [N]
      real(wp) :: force = 0.0_wp                  !! before it deforms: a prestress [N]
      logical :: returns = .false.
   end type frame_link

   type :: frame
      integer :: n = 0                            !! freedoms
      type(macro_element), allocatable :: element(:)
      type(frame_link), allocatable :: link(:)
      real(wp), allocatable :: linear(:, :)       !! (n, n) stiffness of floors and of what else stays elastic
      real(wp), allocatable :: weight(:)          !! (n) constant loads
      real(wp), allocatable :: mass(:, :)         !! (n, n)
   end type frame

   type :: frame_state
      real(wp), allocatable :: d(:)               !! (n) displacements
      real(wp), allocatable :: force(:)           !! (n) internal forces
      real(wp), allocatable :: tangent(:, :)      !! (n, n)
      type(element_state), allocatable :: element(:)
      real(wp), allocatable :: plastic(:)         !! of links [m]
      logical :: lagged = .false.                 !! shear strengths by the forces of the last equilibrium
      logical :: damped = .false.                 !! equilibrium by damped iterations
   end type frame_state

   !> Forces out of balance, over the greatest sum of constant loads
   real(wp), parameter :: tolerance = 1.0e-7_wp
   integer, parameter :: most_iterations = 40, patience = 8, most_damped = 400
   !> Share of the damping that remains after an iteration that leaves the forces out of balance as they were
   real(wp), parameter :: faster = 0.9_wp
   !> Least and greatest damping over the elastic stiffness, and the least and greatest change of it in an iteration
   real(wp), parameter :: damping_range(2) = [1.0e-9_wp, 1.0e2_wp], damping_change(2) = [0.2_wp, 4.0_wp]

   interface
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
   end interface

contains

   !> A frame that has not moved
   pure subroutine frame_state_new(model, state, failed)
      type(frame), intent(in) :: model
      type(frame_state), intent(out) :: state
      integer, intent(out) :: failed             !! not 0: no memory
      allocate (state%d(model%n), state%force(model%n), state%tangent(model%n, model%n), &
         state%element(size(model%element)), state%plastic(size(model%link)), stat=failed)
      if (failed /= 0) return
      state%d(:) = 0.0_wp
      state%force(:) = 0.0_wp
      state%tangent(:, :) = 0.0_wp
      state%plastic(:) = 0.0_wp
   end subroutine frame_state_new

   !> Make a state what another one is
   pure subroutine take_over(from, to)
      type(frame_state), intent(in) :: from
      type(frame_state), intent(inout) :: to     !! with room
      to%d(:) = from%d
      to%force(:) = from%force
      to%tangent(:, :) = from%tangent
      to%element(:) = from%element
      to%plastic(:) = from%plastic
   end subroutine take_over

   !> Internal forces and tangent at the displacements of `now`
   pure subroutine assemble(model, past, now, status)
      type(frame), intent(in) :: model
      type(frame_state), intent(in) :: past
      type(frame_state), intent(inout) :: now
      integer(c_int), intent(out) :: status
      real(wp) :: d(6), force(6), tangent(6, 6)
      integer :: e, i, j
      now%tangent(:, :) = model%linear
      now%force(:) = matmul(model%linear, now%d)
      status = status_ok
      do e = 1, size(model%element)
         associate (freedom => model%element(e)%freedom)
            d = 0.0_wp
            do i = 1, 6
               if (freedom(i) > 0) d(i) = now%d(freedom(i))
            end do
            call element_forces(model%element(e), past%element(e), d, now%lagged, now%element(e), force, tangent, &
               status)
            if (status /= status_ok) then   ! again, from its last equilibrium
               now%element(e) = past%element(e)
               call element_forces(model%element(e), past%element(e), d, now%lagged, now%element(e), force, tangent, &
                  status)
               if (status /= status_ok) return
            end if
            do j = 1, 6
               if (freedom(j) == 0) cycle
               now%force(freedom(j)) = now%force(freedom(j)) + force(j)
               do i = 1, 6
                  if (freedom(i) > 0) now%tangent(freedom(i), freedom(j)) = now%tangent(freedom(i), freedom(j)) &
                     + tangent(i, j)
               end do
            end do
         end associate
      end do
      do e = 1, size(model%link)
         call add_link(model%link(e), past%plastic(e), now, now%plastic(e))
      end do
   end subroutine assemble

   !> Add the force of a link
   pure subroutine add_link(link, past, now, plastic)
      type(frame_link), intent(in) :: link
      real(wp), intent(in) :: past
      type(frame_state), intent(inout) :: now
      real(wp), intent(inout) :: plastic
      real(wp) :: deformation, force, stiffness
      integer :: i, j
      deformation = 0.0_wp
      do i = 1, 8
         if (link%freedom(i) > 0) deformation = deformation + link%part(i) * now%d(link%freedom(i))
      end do
      force = link%force + link%stiffness * (deformation - merge(0.0_wp, past, link%returns))
      stiffness = link%stiffness
      if (force > link%strength(2) .or. force < -link%strength(1)) then
         stiffness = 1.0e-6_wp * link%stiffness
         force = max(-link%strength(1), min(link%strength(2), force))
      end if
      plastic = deformation - (force - link%force) / link%stiffness
      do j = 1, 8
         if (link%freedom(j) == 0) cycle
         now%force(link%freedom(j)) = now%force(link%freedom(j)) + link%part(j) * force
         do i = 1, 8
            if (link%freedom(i) > 0) now%tangent(link%freedom(i), link%freedom(j)) = &
               now%tangent(link%freedom(i), link%freedom(j)) + link%part(i) * link%part(j) * stiffness
         end do
      end do
   end subroutine add_link

   !> Equilibrium under a share of the constant loads and a multiple of `pattern`.
   !>
   !> With `controlled` the multiple is sought at which control . d has the value; else it is kept. A `damped` state is found by
   !> pseudo-transient continuation (Kelley and Keyes 1998): the diagonal of the stiffness times a factor is added to the
   !> tangent, and the factor follows the forces out of balance. Newton's method overshoots where a rigid node turns on a pier
   !> whose force acts at its edge, or a link carries its strength: there the tangent is nearly singular.
   subroutine equilibrate(model, weighed, past, pattern, control, value, controlled, now, multiple, status)
      type(frame), intent(in) :: model
      real(wp), intent(in) :: weighed            !! share of the constant loads
      type(frame_state), intent(in) :: past
      real(wp), intent(in) :: pattern(:)         !! (n)
      real(wp), intent(in) :: control(:)         !! (n)
      real(wp), intent(in) :: value              !! [m]
      logical, intent(in) :: controlled
      type(frame_state), intent(inout) :: now    !! a first guess in
      real(wp), intent(inout) :: multiple
      integer(c_int), intent(out) :: status
      real(wp) :: right(model%n, 2), matrix(model%n, model%n), stiff(model%n), taken(model%n)
      real(wp) :: scale, more, part, damping, out, before
      integer :: iteration, columns, i
      columns = merge(2, 1, controlled)
      damping = merge(1.0_wp, 0.0_wp, now%damped)
      before = huge(1.0_wp)
      stiff = 0.0_wp
      taken = 0.0_wp
      more = 0.0_wp
      do iteration = 1, merge(most_damped, most_iterations, now%damped)
         call assemble(model, past, now, status)
         if (status /= status_ok) then
            if (.not. now%damped .or. iteration == 1) return
            damping = min(damping_range(2), damping_change(2) * damping)   ! half the way back
            taken = 0.5_wp * taken
            more = 0.5_wp * more
            now%d(:) = now%d - taken
            if (controlled) multiple = multiple - more
            cycle
         end if
         right(:, 1) = weighed * model%weight + multiple * pattern - now%force
         right(:, 2) = pattern
         out = maxval(abs(right(:, 1)))
         if (.not. out <= huge(1.0_wp)) exit
         scale = tolerance * max(sum(abs(model%weight)), sum(abs(multiple * pattern)), sum(abs(model%link%force)), &
            tiny(1.0_wp))
         if (iteration > 1 .and. out <= scale) return
         matrix(:, :) = now%tangent
         if (now%damped) then
            if (iteration > 1) damping = min(damping_range(2), max(damping_range(1), damping &
               * min(damping_change(2), max(damping_change(1), faster * out / before))))
            before = max(out, tiny(1.0_wp))
            do i = 1, model%n
               stiff(i) = max(stiff(i), now%tangent(i, i))
               matrix(i, i) = matrix(i, i) + damping * stiff(i)
            end do
         end if
         call solve(matrix, right(:, 1:columns), status)
         if (status /= status_ok) return
         if (controlled) then
            more = (value - dot_product(control, now%d + right(:, 1))) / dot_product(control, right(:, 2))
            right(:, 1) = right(:, 1) + more * right(:, 2)
         end if
         ! Iterations that go to and fro between sliding and sticking settle in shorter steps
         part = 1.0_wp
         if (iteration > patience .and. .not. now%damped) part = merge(0.5_wp, 0.8_wp, mod(iteration, 2) == 0)
         if (controlled) multiple = multiple + part * more
         taken = part * right(:, 1)
         now%d(:) = now%d + taken
      end do
      status = status_too_many_steps
   end subroutine equilibrate

   !> Solve a x = b; a is kept
   subroutine solve(a, b, status)
      real(wp), intent(in) :: a(:, :)
      real(wp), intent(inout) :: b(:, :)         !! right-hand sides in, solutions out
      integer(c_int), intent(out) :: status
      real(wp) :: factors(size(a, 1), size(a, 1)), x(size(b, 1), size(b, 2))
      integer :: pivot(size(a, 1)), info
      factors(:, :) = a
      x(:, :) = b
      call dgesv(size(a, 1), size(b, 2), factors, size(a, 1), pivot, x, size(a, 1), info)
      status = merge(status_ok, status_singular, info == 0)
      b(:, :) = x
   end subroutine solve

   !> Keep a state in equilibrium; how many elements have just reached a drift limit
   pure subroutine commit(model, state, failed)
      type(frame), intent(in) :: model
      type(frame_state), intent(inout) :: state
      integer, intent(out) :: failed
      logical :: one
      integer :: e
      failed = 0
      do e = 1, size(model%element)
         call element_committed(model%element(e), state%element(e))
         call element_failed(model%element(e), state%element(e), one)
         if (one) failed = failed + 1
      end do
   end subroutine commit

end module frame_model
