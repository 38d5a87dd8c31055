!> Impulses at unilateral contacts with Coulomb friction: the velocities of rigid bodies after a time step or a blow, in
!> the plane (three freedoms of a body, one direction of sliding) or in space (six, two).
!>
!> With masses M, velocities f that the bodies would have without contacts, and for each contact point the parting
!> velocity w_n = n.v + b_n and the sliding velocity w_t = t.v + b_t (Moreau 1988, Jean 1999):
!>
!>    M (v - f) = sum of n p_n + t p_t,    0 <= p_n  _|_  w_n >= 0,    |p_t| <= mu p_n, p_t opposes w_t.
!>
!> With the parting velocities raised by c = mu |w_t| this says that impulses lie in the friction cone and velocities in
!> its dual, at right angles (de Saxce and Feng 1998). For c held it is a convex problem, and c follows from round to
!> round (Acary, Cadoux, Lemarechal and Malick 2011); where it creeps or swings for long in space, it is taken to where
!> the last two rounds point (Anderson 1965). The convex problem is solved by augmented Lagrangians (Alart and
!> Curnier 1991): with weights r the impulses are those which the projection on the cone
!>
!>    p = P(p - r (w_n + c, w_t))
!>
!> leaves unchanged. For p held on the right, the velocities are those of least energy: the unique minimum of a convex
!> function, sum of squares of projections, which Newton's method finds in a few steps, with one sparse factorisation
!> for each set of points that stick, slide and part, and in space for each turn of what slides, where the cone is
!> round. Then p and c follow together; few rounds are needed, since the weights are large. Where more impulses than
!> velocities are unknown (two points of a joint, arches), those nearest to the ones at the start are found.
!>
!> Points that never slide (`no_sliding`) have c = 0 and the half space p_n >= 0 for a cone: the problem is convex as it
!> is, and the velocities are those nearest to f, in kinetic energy, at which nothing overlaps or slides.
module nonsmooth_impulses
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use nonsmooth_skyline, only : skyline, skyline_add, skyline_factor, skyline_new, skyline_solve
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: impulse_problem, impulse_effort, problem_new, problem_room, solve_impulses

   !> Directions at a contact point: the normal, then those of sliding
   integer, parameter, public :: along_normal = 1, along_tangent = 2
   integer, parameter, public :: in_plane = 2, in_space = 3
   !> Friction of points that never slide, nor where they part: the cone is a half space (its square does not overflow)
   real(wp), parameter, public :: no_sliding = 1.0e100_wp
   real(wp), parameter :: growth = 10.0_wp       !! of the weights where impulses have far to go
   integer, parameter :: patience = 15           !! rounds before that
   integer, parameter :: most_growth = 2         !! times
   integer, parameter :: most_newton = 60
   integer, parameter :: now = 1, before = 2     !! round
   integer, parameter :: most_halvings = 30
   !> What a point does. A cone in the plane has two edges; on the round one in space that is one state
   integer, parameter :: parts = 0, sticks = 1, slides = 2, slides_back = 3

   type :: impulse_problem
      integer :: directions = 0                     !! in_plane or in_space
      integer :: freedoms = 0                       !! of a body: 3 or 6
      integer :: nodes = 0                          !! bodies that move
      integer :: points = 0
      real(wp) :: heavy = 1.0e2_wp                  !! weights over the mass that a point feels
      real(wp), allocatable :: mass(:)              !! (freedoms nodes) by rank: of each freedom, mass or inertia
      real(wp), allocatable :: free(:)              !! (freedoms nodes) velocities without contacts
      real(wp), allocatable :: rate(:)              !! (freedoms nodes) velocities: a guess in, the answer out
      integer, allocatable :: node(:, :)            !! (2, points) ranks of both bodies, 0 where one is prescribed
      real(wp), allocatable :: row(:, :, :, :)      !! (freedoms, side, direction, points): w = sum of row.v + shift
      real(wp), allocatable :: shift(:, :)          !! (direction, points) [m/s]
      real(wp), allocatable :: friction(:)          !! (points) coefficient
      real(wp), allocatable :: impulse(:, :)        !! (direction, points): a guess in, the answer out [N s]
      real(wp), allocatable :: best(:, :)           !! (direction, points) impulses of the round of least violation
      type(skyline) :: matrix
      real(wp), allocatable :: weight(:)            !! (points) r
      real(wp), allocatable :: raised(:)            !! (points) c [m/s]
      real(wp), allocatable :: asked(:, :)          !! (points, now and before) c by the sliding found [m/s]
      real(wp), allocatable :: change(:, :)         !! (points, now and before) of c that was so asked for [m/s]
      real(wp), allocatable :: rate_at(:, :)        !! (direction, points) w [m/s]
      real(wp), allocatable :: trial(:, :)          !! (direction, points) p - r (w_n + c, w_t)
      real(wp), allocatable :: try(:), load(:)      !! (freedoms nodes)
      integer, allocatable :: state(:), was(:)      !! (points) what they do, and did when the matrix was factored
   end type impulse_problem

   !> What a solution took
   type :: impulse_effort
      integer :: rounds = 0                         !! new impulses
      integer :: factors = 0                        !! sparse factorisations
      real(wp) :: residual = 0.0_wp                 !! greatest violation of the law, as a velocity [m/s]
      logical :: converged = .false.
   end type impulse_effort

contains

   !> A problem of `nodes` bodies, `links` pairs of which may touch
   subroutine problem_new(nodes, directions, link, problem, status)
      integer, intent(in) :: nodes
      integer, intent(in) :: directions             !! in_plane or in_space
      integer, intent(in) :: link(:, :)             !! (2, links)
      type(impulse_problem), intent(out) :: problem
      integer(c_int), intent(out) :: status
      integer :: count, failed
      problem%nodes = nodes
      problem%directions = directions
      problem%freedoms = merge(3, 6, directions == in_plane)
      call skyline_new(nodes, problem%freedoms, link, problem%matrix, status)
      if (status /= status_ok) return
      count = problem%freedoms * nodes
      allocate (problem%mass(count), problem%free(count), problem%rate(count), problem%try(count), &
         problem%load(count), stat=failed)
      if (failed /= 0) status = status_out_of_memory
   end subroutine problem_new

   !> Room for `points` contact points, instead of what there was
   subroutine problem_room(problem, points, status)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: points
      integer(c_int), intent(out) :: status
      integer :: failed
      if (allocated(problem%node)) deallocate (problem%node, problem%row, problem%shift, problem%friction, &
         problem%impulse, problem%best, problem%weight, problem%raised, problem%asked, problem%change, &
         problem%rate_at, problem%trial, problem%state, problem%was)
      allocate (problem%node(2, points), problem%row(problem%freedoms, 2, problem%directions, points), &
         problem%shift(problem%directions, points), problem%friction(points), &
         problem%impulse(problem%directions, points), problem%best(problem%directions, points), &
         problem%weight(points), problem%raised(points), problem%asked(points, 2), problem%change(points, 2), &
         problem%rate_at(problem%directions, points), problem%trial(problem%directions, points), &
         problem%state(points), problem%was(points), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
   end subroutine problem_room

   !> Impulses and velocities
   pure subroutine solve_impulses(problem, tolerance, most_rounds, effort)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: tolerance             !! violation that is let pass [m/s]
      integer, intent(in) :: most_rounds
      type(impulse_effort), intent(out) :: effort
      real(wp) :: residual
      integer :: k, n

      n = problem%points
      call weigh(problem)
      problem%was(:n) = -1
      problem%raised(:n) = 0.0_wp
      call look(problem, problem%rate)
      do k = 1, n
         problem%raised(k) = raising(problem%friction(k), problem%rate_at(along_tangent:, k))
      end do
      do while (effort%rounds < most_rounds)
         effort%rounds = effort%rounds + 1
         call least_energy(problem, tolerance, effort)
         call take_impulses(problem, residual)
         if (effort%rounds == 1 .or. residual < effort%residual) then
            effort%residual = residual
            problem%best(:, :n) = problem%impulse(:, :n)
         end if
         call follow(problem, effort%rounds)
         effort%converged = effort%residual <= tolerance
         if (effort%converged) exit
         if (mod(effort%rounds, patience) > 0 .or. effort%rounds > patience * most_growth) cycle
         problem%weight(:n) = growth * problem%weight(:n)
         problem%was(:n) = -1
      end do
      problem%impulse(:, :n) = problem%best(:, :n)
      call velocities(problem)
   end subroutine solve_impulses

   !> Weights: many times the mass that a point feels
   pure subroutine weigh(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: k, d, side, at
      real(wp) :: lightness(in_space)
      do k = 1, problem%points
         lightness = 0.0_wp
         do d = 1, problem%directions
            do side = 1, 2
               if (problem%node(side, k) == 0) cycle
               at = problem%freedoms * (problem%node(side, k) - 1)
               lightness(d) = lightness(d) &
                  + sum(problem%row(:, side, d, k)**2 / problem%mass(at + 1:at + problem%freedoms))
            end do
         end do
         problem%weight(k) = problem%heavy / maxval(lightness)
      end do
   end subroutine weigh

   !> Velocities at the points, trial impulses, and what the points do, at some velocities of the bodies
   pure subroutine look(problem, rate)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: rate(:)
      integer :: k, d, side, at
      real(wp) :: w
      do k = 1, problem%points
         do d = 1, problem%directions
            w = problem%shift(d, k)
            do side = 1, 2
               if (problem%node(side, k) == 0) cycle
               at = problem%freedoms * (problem%node(side, k) - 1)
               w = w + dot_product(problem%row(:, side, d, k), rate(at + 1:at + problem%freedoms))
            end do
            problem%rate_at(d, k) = w
            problem%trial(d, k) = problem%impulse(d, k) &
               - problem%weight(k) * (w + merge(problem%raised(k), 0.0_wp, d == along_normal))
         end do
         problem%state(k) = state_of(problem%friction(k), problem%trial(:, k))
      end do
   end subroutine look

   !> Length of what a point slides by, or of the impulse that opposes it
   pure function length(along) result(l)
      real(wp), intent(in) :: along(:)              !! (1) in the plane, (2) in space
      real(wp) :: l
      l = abs(along(1))
      if (size(along) > 1) l = hypot(along(1), along(2))
   end function length

   !> Where a trial impulse lies: in the friction cone, in its polar cone, or beside
   pure function state_of(friction, trial) result(state)
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: trial(:)
      integer :: state
      real(wp) :: across
      across = length(trial(along_tangent:))
      if (trial(along_normal) >= 0.0_wp .and. across <= friction * trial(along_normal)) then
         state = sticks
      else if (friction * across <= -trial(along_normal)) then
         state = parts
      else
         state = slides
         if (size(trial) == in_plane .and. trial(along_tangent) < 0.0_wp) state = slides_back
      end if
   end function state_of

   !> c: by how much the parting velocity is raised where a point slides
   pure function raising(friction, sliding) result(c)
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: sliding(:)            !! [m/s]
      real(wp) :: c
      c = 0.0_wp
      if (friction < no_sliding) c = friction * length(sliding)
   end function raising

   !> The edge of the friction cone on which a point slides: unit vector of its impulse; and by what share the edge
   !> turns as the trial impulse turns about the normal
   pure subroutine edge_of(friction, trial, edge, turning)
      real(wp), intent(in) :: friction
      real(wp), intent(in) :: trial(:)
      real(wp), intent(out) :: edge(in_space)       !! the last is 0 in the plane
      real(wp), intent(out) :: turning              !! 0 to 1; of no account in the plane
      real(wp) :: across, root
      integer :: d
      across = length(trial(along_tangent:))
      root = sqrt(1.0_wp + friction**2)
      edge(in_space) = 0.0_wp
      edge(along_normal) = 1.0_wp / root
      do d = along_tangent, size(trial)
         edge(d) = friction * (trial(d) / across) / root
      end do
      turning = friction / (1.0_wp + friction**2) * (trial(along_normal) / across + friction)
   end subroutine edge_of

   !> The derivative of the projection on the cone at a trial impulse, applied to an impulse. Of the trial itself that
   !> is the point of the cone nearest to it
   pure function projected(friction, state, trial, impulse) result(near)
      real(wp), intent(in) :: friction
      integer, intent(in) :: state
      real(wp), intent(in) :: trial(:)
      real(wp), intent(in) :: impulse(in_space)     !! the last is 0 in the plane
      real(wp) :: near(in_space)
      real(wp) :: edge(in_space), turning, across(2)
      select case (state)
      case (sticks)
         near = impulse
      case (parts)
         near = 0.0_wp
      case default
         call edge_of(friction, trial, edge, turning)
         near = edge * dot_product(edge, impulse)
         if (size(trial) == in_plane) return
         across = across_of(trial)
         near(2:3) = near(2:3) + turning * dot_product(across, impulse(2:3)) * across
      end select
   end function projected

   !> In space: the direction of sliding at a right angle to a trial impulse
   pure function across_of(trial) result(across)
      real(wp), intent(in) :: trial(:)
      real(wp) :: across(2)
      across = [-trial(3), trial(2)] / length(trial(along_tangent:))
   end function across_of

   !> The function that is least at the velocities sought, at velocities that have been looked at
   pure function energy(problem, rate) result(total)
      type(impulse_problem), intent(in) :: problem
      real(wp), intent(in) :: rate(:)
      real(wp) :: total
      integer :: k
      total = sum(problem%mass * (rate - problem%free)**2)
      do k = 1, problem%points
         total = total + sum(nearest_point(problem, k)**2) / problem%weight(k)
      end do
      total = 0.5_wp * total
   end function energy

   !> The point of the friction cone nearest to a trial impulse
   pure function nearest_point(problem, k) result(near)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k                      !! point
      real(wp) :: near(in_space)
      real(wp) :: trial(in_space)
      trial(in_space) = 0.0_wp
      trial(:problem%directions) = problem%trial(:, k)
      near = projected(problem%friction(k), problem%state(k), problem%trial(:, k), trial)
   end function nearest_point

   !> Newton's method for the velocities at which that function is least
   pure subroutine least_energy(problem, tolerance, effort)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(in) :: tolerance             !! [m/s]
      type(impulse_effort), intent(inout) :: effort
      integer :: n, round, halving
      real(wp) :: present, next, off
      logical :: whole, still, same
      integer(c_int) :: status

      n = problem%points
      call look(problem, problem%rate)
      present = energy(problem, problem%rate)
      do round = 1, most_newton
         if (.not. unchanged(problem)) then
            call assemble(problem)
            call skyline_factor(problem%matrix, status)
            problem%was(:n) = problem%state(:n)
            effort%factors = effort%factors + 1
            if (status /= status_ok) return          ! not finite: the caller sees velocities that are not
         end if
         call right_side(problem)
         problem%try(:) = problem%load
         call skyline_solve(problem%matrix, problem%try)
         do halving = 0, most_halvings
            call look(problem, problem%try)
            next = energy(problem, problem%try)
            if (.not. next > present + 1.0e-12_wp * abs(present)) exit
            problem%try(:) = 0.5_wp * (problem%try + problem%rate)
         end do
         whole = halving == 0
         ! Points on the verge of sliding may change sides for ever and move nothing.
         still = whole .and. maxval(abs(problem%try - problem%rate)) < 0.01_wp * tolerance
         problem%rate(:) = problem%try
         present = next
         same = whole
         if (same) same = unchanged(problem)
         if (still .or. same) return
         ! On a round cone: has what slides turned no farther than the matrix knew?
         if (whole .and. problem%directions == in_space) then
            call missing(problem, off)
            if (off < 0.01_wp * tolerance) return
         end if
      end do
   end subroutine least_energy

   !> The impulses that are missing at velocities that have been looked at, as the greatest change of a velocity by
   !> them; the minimum is no farther
   pure subroutine missing(problem, greatest)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(out) :: greatest             !! [m/s]
      integer :: k
      problem%load(:) = problem%mass * (problem%free - problem%rate)
      do k = 1, problem%points
         if (problem%state(k) /= parts) call add_impulse(problem, k, nearest_point(problem, k), problem%load)
      end do
      greatest = maxval(abs(problem%load / problem%mass))
   end subroutine missing

   !> Whether the matrix is that of what the points do now: where one slides on a round cone it changes all the time
   pure function unchanged(problem) result(same)
      type(impulse_problem), intent(in) :: problem
      logical :: same
      associate (state => problem%state(:problem%points), was => problem%was(:problem%points))
         same = .not. any(state /= was)
         if (same .and. problem%directions == in_space) same = .not. any(state == slides)
      end associate
   end function unchanged

   !> M + sum of r row row' over the directions in which points resist
   pure subroutine assemble(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: i, k, d, n
      real(wp) :: edge(in_space), across(2), row(6, 2), turning
      n = problem%freedoms
      problem%matrix%a(:) = 0.0_wp
      do i = 1, problem%matrix%n
         problem%matrix%a(problem%matrix%start(i) + i) = problem%mass(i)
      end do
      do k = 1, problem%points
         select case (problem%state(k))
         case (sticks)
            do d = 1, problem%directions
               call add_row(problem, k, problem%weight(k), problem%row(:, :, d, k))
            end do
         case (slides, slides_back)
            call edge_of(problem%friction(k), problem%trial(:, k), edge, turning)
            row(:n, :) = edge(1) * problem%row(:, :, 1, k)
            do d = along_tangent, problem%directions
               row(:n, :) = row(:n, :) + edge(d) * problem%row(:, :, d, k)
            end do
            call add_row(problem, k, problem%weight(k), row(:n, :))
            if (problem%directions == in_plane) cycle
            across = across_of(problem%trial(:, k))
            row(:n, :) = across(1) * problem%row(:, :, 2, k) + across(2) * problem%row(:, :, 3, k)
            call add_row(problem, k, turning * problem%weight(k), row(:n, :))
         case default
            cycle
         end select
      end do
   end subroutine assemble

   pure subroutine add_row(problem, k, weight, row)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: k                      !! point
      real(wp), intent(in) :: weight
      real(wp), intent(in) :: row(:, :)             !! (freedoms, 2) of both bodies
      associate (node => problem%node(:, k))
         if (node(1) > 0) call skyline_add(problem%matrix, node(1), node(1), weight, row(:, 1), row(:, 1))
         if (node(2) > 0) call skyline_add(problem%matrix, node(2), node(2), weight, row(:, 2), row(:, 2))
         if (all(node > 0)) call skyline_add(problem%matrix, node(1), node(2), weight, row(:, 1), row(:, 2))
      end associate
   end subroutine add_row

   !> M f + what the points give at rest
   pure subroutine right_side(problem)
      type(impulse_problem), intent(inout) :: problem
      integer :: k
      real(wp) :: rest(in_space)
      rest(in_space) = 0.0_wp
      problem%load(:) = problem%mass * problem%free
      do k = 1, problem%points
         if (problem%state(k) == parts) cycle
         rest(:problem%directions) = problem%shift(:, k)
         rest(along_normal) = rest(along_normal) + problem%raised(k)
         rest(:problem%directions) = problem%impulse(:, k) - problem%weight(k) * rest(:problem%directions)
         call add_impulse(problem, k, projected(problem%friction(k), problem%state(k), problem%trial(:, k), rest), &
            problem%load)
      end do
   end subroutine right_side

   !> Add an impulse at a point to the momentum of both bodies
   pure subroutine add_impulse(problem, k, impulse, momentum)
      type(impulse_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(wp), intent(in) :: impulse(in_space)     !! the last is 0 in the plane [N s]
      real(wp), intent(inout) :: momentum(:)
      integer :: side, at, d, i
      real(wp) :: given
      do side = 1, 2
         if (problem%node(side, k) == 0) cycle
         at = problem%freedoms * (problem%node(side, k) - 1)
         do i = 1, problem%freedoms
            given = momentum(at + i)
            do d = 1, problem%directions
               given = given + impulse(d) * problem%row(i, side, d, k)
            end do
            momentum(at + i) = given
         end do
      end do
   end subroutine add_impulse

   !> New impulses from the trial ones, and by how much the law was violated
   pure subroutine take_impulses(problem, residual)
      type(impulse_problem), intent(inout) :: problem
      real(wp), intent(out) :: residual             !! [m/s]
      real(wp) :: impulse(in_space), raised
      integer :: k, n
      n = problem%directions
      residual = 0.0_wp
      do k = 1, problem%points
         impulse = nearest_point(problem, k)
         raised = raising(problem%friction(k), problem%rate_at(along_tangent:, k))
         residual = max(residual, maxval(abs(impulse(:n) - problem%impulse(:, k))) / problem%weight(k))
         if (problem%state(k) > sticks) residual = max(residual, abs(raised - problem%raised(k)))
         problem%impulse(:, k) = impulse(:n)
         problem%asked(k, now) = raised
      end do
   end subroutine take_impulses

   !> c for the next round: as was found, and where that comes no nearer for long in space, as it would come to rest if
   !> every change were that share of the one before it that the last two show (Anderson 1965, of one round). In the
   !> plane, where what slides cannot turn, more steps converge so, but the others miss by more
   pure subroutine follow(problem, rounds)
      type(impulse_problem), intent(inout) :: problem
      integer, intent(in) :: rounds                 !! so far
      real(wp), parameter :: farthest = 100.0_wp     !! changes at once
      real(wp) :: back, square, share
      logical :: far
      integer :: k
      far = problem%directions == in_space .and. rounds > patience * most_growth + 1
      back = 0.0_wp
      square = 0.0_wp
      do k = 1, problem%points
         problem%change(k, now) = problem%asked(k, now) - problem%raised(k)
         if (.not. far) cycle
         back = back + problem%change(k, now) * (problem%change(k, now) - problem%change(k, before))
         square = square + (problem%change(k, now) - problem%change(k, before))**2
      end do
      share = 0.0_wp
      if (square > 0.0_wp) share = max(-farthest, back / square)
      do k = 1, problem%points
         problem%raised(k) = problem%asked(k, now)
         if (abs(share) > 0.0_wp) problem%raised(k) = max(0.0_wp, &
            problem%asked(k, now) - share * (problem%asked(k, now) - problem%asked(k, before)))
      end do
      problem%asked(:problem%points, before) = problem%asked(:problem%points, now)
      problem%change(:problem%points, before) = problem%change(:problem%points, now)
   end subroutine follow

   !> Velocities that follow from the impulses
   pure subroutine velocities(problem)
      type(impulse_problem), intent(inout) :: problem
      real(wp) :: impulse(in_space)
      integer :: k
      impulse(in_space) = 0.0_wp
      problem%rate(:) = problem%mass * problem%free
      do k = 1, problem%points
         impulse(:problem%directions) = problem%impulse(:, k)
         call add_impulse(problem, k, impulse, problem%rate)
      end do
      problem%rate(:) = problem%rate / problem%mass
   end subroutine velocities

end module nonsmooth_impulses
